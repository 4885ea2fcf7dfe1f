#include "contact/separation.hpp"

namespace talus {

Separation separation(const PlacedPart& a, const PlacedPart& b, double dx, double dy) {
    Separation best;
    for (int k = 0; k < a.n; ++k) {
        const double distance = separation_by_edge(a, k, b, dx, dy);
        if (distance > best.distance) best = {distance, k, true};
    }
    for (int k = 0; k < b.n; ++k) {
        const double distance = separation_by_edge(b, k, a, -dx, -dy);
        if (distance > best.distance) best = {distance, k, false};
    }
    return best;
}

int facing_edge(const PlacedPart& other, double nx, double ny) {
    int best = 0;
    double least = 2.0;
    for (int k = 0; k < other.n; ++k) {
        const double cosine = other.normal(k).x() * nx + other.normal(k).y() * ny;
        if (cosine < least) least = cosine, best = k;
    }
    return best;
}

}  // namespace talus
