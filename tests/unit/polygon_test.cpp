#include "geometry/polygon.hpp"
#include "support/catch.hpp"

using namespace talus;

namespace {

Polygon moved(Polygon polygon, const Vec2& by) {
    for (Vec2& p : polygon) p += by;
    return polygon;
}

Polygon turned(Polygon polygon, double angle) {
    for (Vec2& p : polygon)
        p = Vec2(std::cos(angle) * p.x() - std::sin(angle) * p.y(), std::sin(angle) * p.x() + std::cos(angle) * p.y());
    return polygon;
}

const Polygon rectangle{{0, 0}, {4, 0}, {4, 2}, {0, 2}};
const Polygon u_shape{{0, 0}, {3, 0}, {3, 3}, {2, 3}, {2, 1}, {1, 1}, {1, 3}, {0, 3}};
const Polygon bow_tie{{0, 0}, {2, 2}, {2, 0}, {0, 2}};

}  // namespace

TEST_CASE("area, centroid and inertia of a rectangle and of a triangle are those of the textbook") {
    CHECK(signed_area(rectangle) == 8.0);
    CHECK(signed_area(Polygon(rectangle.rbegin(), rectangle.rend())) == -8.0);
    CHECK((centroid(rectangle) - Vec2(2, 1)).norm() < 1e-15);
    CHECK(polar_moment(rectangle) == Approx(4.0 * 2.0 * (16.0 + 4.0) / 12.0).epsilon(1e-15));  // b h (b2 + h2) / 12
    CHECK(perimeter(rectangle) == 12.0);

    const Polygon triangle{{0, 0}, {3, 0}, {0, 3}};
    CHECK((centroid(triangle) - Vec2(1, 1)).norm() < 1e-15);
    CHECK(polar_moment(triangle) == Approx(4.5 / 36.0 * (9.0 + 18.0 + 9.0)).epsilon(1e-15));  // A (a2 + b2 + c2) / 36
}

TEST_CASE("measures of a small polygon a thousand kilometres away lose no digits") {
    // corners that are exact in binary, so that moving them rounds nothing
    const Polygon small{{0, 0}, {0.5, 0.125}, {0.625, 0.5}, {0.25, 0.75}, {-0.125, 0.375}};
    const Vec2 far(4.5e5, 6.5e6);
    const Polygon there = moved(small, far);
    CHECK(signed_area(there) == Approx(signed_area(small)).epsilon(1e-14));
    CHECK(polar_moment(there) == Approx(polar_moment(small)).epsilon(1e-8));  // the centroid has only 1e-9 m there
    CHECK((centroid(there) - far - centroid(small)).norm() < 2e-9);
    CHECK(smallest_width(there) == Approx(smallest_width(small)).epsilon(1e-14));
    CHECK(is_convex(there));
    CHECK(contains(there, far + Vec2(0.25, 0.25)));
}

TEST_CASE("a polygon that crosses itself names the two edges") {
    CHECK(is_simple(u_shape));
    const auto crossing = crossing_edges(bow_tie);
    REQUIRE(crossing);
    CHECK(*crossing == std::pair(0, 2));
    CHECK_FALSE(is_simple(Polygon{{0, 0}, {4, 0}, {4, 4}, {2, 0}, {0, 4}}));  // a corner on another edge
    CHECK_FALSE(is_simple(Polygon{{0, 0}, {4, 0}, {2, 0}, {0, 4}}));          // folded back
    CHECK_FALSE(is_simple(Polygon{{0, 0}, {4, 0}, {4, 0}, {0, 4}}));          // doubled corner
    CHECK_FALSE(is_simple(Polygon{{0, 0}, {4, 0}}));
}

TEST_CASE("convex polygons turn left once around") {
    CHECK(is_convex(rectangle));
    CHECK_FALSE(is_convex(Polygon(rectangle.rbegin(), rectangle.rend())));
    CHECK_FALSE(is_convex(u_shape));
    Polygon star;
    for (int i = 0; i < 5; ++i) star.emplace_back(std::cos(radians(144.0 * i)), std::sin(radians(144.0 * i)));
    CHECK_FALSE(is_convex(star));
    CHECK(is_convex(Polygon{{0, 0}, {0.1, 0.1}, {0.2, 0.2}, {0.3, 0.3}, {0, 0.3}}));  // straight but for rounding
}

TEST_CASE("straight and doubled corners are left out, true ones stay") {
    const Polygon square{{0, 0}, {0.1, 0}, {0.3, 0}, {0.3, 0.1}, {0.3, 0.3}, {0.3, 0.3}, {0.2, 0.3}, {0, 0.3}, {0, 0.2}};
    CHECK(without_straight_corners(square) == Polygon{{0, 0}, {0.3, 0}, {0.3, 0.3}, {0, 0.3}});
    const Polygon tilted = turned({{0, 0}, {1, 0}, {2, 0}, {3, 0}, {3, 1}, {0, 1}}, 0.7);
    CHECK(without_straight_corners(tilted) == Polygon{tilted[0], tilted[3], tilted[4], tilted[5]});
    CHECK(without_straight_corners(u_shape) == u_shape);
    const Polygon slightly_bent{{0, 0}, {1, -1e-9}, {2, 0}, {1, 1}};
    CHECK(without_straight_corners(slightly_bent).size() == 4);
    CHECK(without_straight_corners(Polygon{{0, 0}, {1, 1}, {2, 2}}).size() < 3);
}

TEST_CASE("a point lies inside a concave polygon or in its notch") {
    CHECK(contains(u_shape, {0.5, 2.5}));
    CHECK(contains(u_shape, {2.5, 2.5}));
    CHECK(contains(u_shape, {1.5, 0.5}));
    CHECK_FALSE(contains(u_shape, {1.5, 2.0}));
    CHECK_FALSE(contains(u_shape, {-1.0, 1.0}));  // the ray to the right passes along the floor of the notch
    CHECK(contains(Polygon(u_shape.rbegin(), u_shape.rend()), {0.5, 1.0}));
}

TEST_CASE("the smallest width of a convex polygon is that of the narrowest strip around it") {
    CHECK(smallest_width(turned(rectangle, 0.4)) == Approx(2.0).epsilon(1e-15));
    CHECK(smallest_width(Polygon{{0, 0}, {2, 0}, {1, std::sqrt(3.0)}}) == Approx(std::sqrt(3.0)).epsilon(1e-15));
}

TEST_CASE("overlap is the shortest move that parts two polygons, in any position") {
    for (const double angle : {0.0, 0.3, 2.0}) {
        const auto at = [&](double x, double y) { return turned(moved(rectangle, {x, y}), angle); };
        CHECK(overlap_depth(at(0, 0), at(3.5, 1.0)) == Approx(0.5).margin(1e-14));
        CHECK(overlap_depth(at(0, 0), at(0.5, 1.9)) == Approx(0.1).margin(1e-14));
        CHECK(overlap_depth(at(0, 0), at(4, 0)) == Approx(0.0).margin(1e-14));
        CHECK(overlap_depth(at(0, 0), at(4.25, 0.3)) == Approx(-0.25).margin(1e-14));
    }
    const Polygon diamond{{0, -1}, {1, 0}, {0, 1}, {-1, 0}};  // corner against corner: the way out is along its own faces
    CHECK(overlap_depth(rectangle, moved(diamond, {4.4, 2.4})) == Approx(0.1 * std::sqrt(2.0)).margin(1e-14));
}

TEST_CASE("a segment through a concave polygon is cut into the pieces inside") {
    const auto pieces = pieces_inside(u_shape, {-1, 2}, {4, 2});
    REQUIRE(pieces.size() == 2);
    CHECK((pieces[0].first - Vec2(0, 2)).norm() + (pieces[0].second - Vec2(1, 2)).norm() < 1e-14);
    CHECK((pieces[1].first - Vec2(2, 2)).norm() + (pieces[1].second - Vec2(3, 2)).norm() < 1e-14);
    CHECK(pieces_inside(u_shape, {0.25, 0.5}, {0.75, 0.5}) == std::vector{std::pair(Vec2(0.25, 0.5), Vec2(0.75, 0.5))});
    CHECK(pieces_inside(u_shape, {1.5, 2}, {1.5, 4}).empty());
    CHECK(pieces_inside(u_shape, {0.5, -1}, {0.5, 9}).size() == 1);
}
