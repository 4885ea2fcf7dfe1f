#include "core/spelling.hpp"

#include <algorithm>
#include <numeric>
#include <vector>

namespace talus {

int edit_distance(std::string_view a, std::string_view b) {
    std::vector<int> row(b.size() + 1);  // distances from the beginning of a, so far, to every beginning of b
    std::iota(row.begin(), row.end(), 0);
    for (std::size_t i = 0; i < a.size(); ++i) {
        int diagonal = row[0]++;
        for (std::size_t j = 0; j < b.size(); ++j) {
            const int replaced = diagonal + (a[i] != b[j]);
            diagonal = row[j + 1];
            row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
        }
    }
    return row.back();
}

std::string_view nearest_spelling(std::string_view word, std::span<const std::string_view> allowed) {
    // One slip in three letters is still a slip; at twice that, "grid" would be taken for "direct".
    int least = static_cast<int>(word.size() + 2) / 3;
    std::string_view nearest;
    for (const std::string_view candidate : allowed) {
        const int distance = edit_distance(word, candidate);
        if (distance > least || (distance == least && !nearest.empty())) continue;
        least = distance;
        nearest = candidate;
    }
    return nearest;
}

}  // namespace talus
