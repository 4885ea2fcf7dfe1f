#include "core/spelling.hpp"

#include "support/catch.hpp"

#include <array>

using namespace talus;

TEST_CASE("the edit distance counts letters inserted, deleted and replaced") {
    CHECK(edit_distance("kitten", "sitting") == 3);
    CHECK(edit_distance("", "abc") == 3);
    CHECK(edit_distance("abc", "") == 3);
    CHECK(edit_distance("friction", "friction") == 0);
    CHECK(edit_distance("ab", "ba") == 2);
}

TEST_CASE("the nearest spelling is the word that was meant, or none") {
    constexpr std::array<std::string_view, 4> keys = {"cohesion", "tension", "friction_angle_deg", "dilation_angle_deg"};
    CHECK(nearest_spelling("cohesoin", keys) == "cohesion");
    CHECK(nearest_spelling("tensoin", keys) == "tension");
    CHECK(nearest_spelling("friction_angle", keys) == "friction_angle_deg");
    CHECK(nearest_spelling("colour", keys).empty());
    CHECK(nearest_spelling("", keys).empty());
}

TEST_CASE("of words equally near the first is named") {
    constexpr std::array<std::string_view, 2> keys = {"west", "rest"};
    CHECK(nearest_spelling("test", keys) == "west");
}
