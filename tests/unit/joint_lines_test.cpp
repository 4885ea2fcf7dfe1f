#include "model/joint_lines.hpp"
#include "core/errors.hpp"
#include "geometry/cut.hpp"
#include "geometry/polygon.hpp"
#include "model/trace_lines.hpp"
#include "support/catch.hpp"

#include <algorithm>
#include <map>
#include <set>

using namespace talus;

namespace {

Polygon square(double size) { return {{-size, -size}, {size, -size}, {size, size}, {-size, size}}; }

JointSetSpec joint_set(double angle_deg, double spacing) {
    JointSetSpec set;
    set.name = "bedding";
    set.angle = {radians(angle_deg), 0.0, Distribution::normal};
    set.spacing = {spacing, 0.0, Distribution::normal};
    return set;
}

double distance(const CutLine& line, const Vec2& point) {
    return std::abs(cross((line.to - line.from).normalized(), point - line.from));
}

/// Signed distances of parallel lines from the origin, ascending.
std::vector<double> offsets(const std::vector<CutLine>& lines, double angle) {
    std::vector<double> result;
    for (const CutLine& line : lines) result.push_back(Vec2(-std::sin(angle), std::cos(angle)).dot(line.from));
    std::sort(result.begin(), result.end());
    return result;
}

struct Statistics {
    double mean, deviation, least, most;
};
Statistics statistics(const std::vector<double>& x) {
    double sum = 0.0, squares = 0.0;
    for (const double v : x) sum += v;
    const double mean = sum / static_cast<double>(x.size());
    for (const double v : x) squares += (v - mean) * (v - mean);
    return {mean, std::sqrt(squares / static_cast<double>(x.size())), *std::min_element(x.begin(), x.end()),
            *std::max_element(x.begin(), x.end())};
}

std::vector<double> spacings(const JointSetSpec& set, double size) {
    const auto at = offsets(joint_set_lines(set, bounds(square(size)), 0), set.angle.mean);
    std::vector<double> result;
    for (std::size_t i = 1; i < at.size(); ++i) result.push_back(at[i] - at[i - 1]);
    return result;
}

}  // namespace

TEST_CASE("joint lines lie at their angle, one spacing apart, and one passes through the origin") {
    JointSetSpec set = joint_set(-35.0, 2.0);
    set.origin = {3.0, -1.0};
    const auto lines = joint_set_lines(set, bounds(square(20)), 4);
    const auto at = offsets(lines, radians(-35.0));
    // width of the square across the set: 2 x 20 (sin 35 + cos 35)
    CHECK(std::abs(static_cast<double>(at.size()) - 40.0 * (std::sin(radians(35.0)) + std::cos(radians(35.0))) / 2.0) <=
          1.0);
    for (std::size_t i = 1; i < at.size(); ++i) CHECK(at[i] - at[i - 1] == Approx(2.0).epsilon(1e-12));
    double nearest = 1.0;
    for (const CutLine& line : lines) {
        nearest = std::min(nearest, distance(line, set.origin));
        const Vec2 along = line.to - line.from;
        CHECK(along.y() / along.x() == Approx(std::tan(radians(-35.0))).epsilon(1e-12));
        CHECK(line.source == 4);
    }
    CHECK(nearest < 1e-14);
}

TEST_CASE("horizontal and vertical joints lie exactly on whole spacings") {
    for (const double angle : {0.0, 90.0, 180.0, -90.0}) {
        const bool level = angle == 0.0 || angle == 180.0;
        for (const CutLine& line : joint_set_lines(joint_set(angle, 0.5), bounds(square(3)), 0)) {
            const double a = level ? line.from.y() : line.from.x(), b = level ? line.to.y() : line.to.x();
            CHECK(a == b);
            CHECK(a / 0.5 == std::round(a / 0.5));
        }
    }
}

TEST_CASE("lines reach past the outline, whatever its shape") {
    RockSpec rock;
    rock.outline = {{0, 0}, {60, 0}, {60, 15}, {40, 15}, {25, 40}, {0, 40}};
    rock.joint_sets = {joint_set(-35.0, 2.0), joint_set(70.0, 3.0)};
    for (const CutLine& line : joint_lines(rock)) {
        CHECK_FALSE(contains(rock.outline, line.from));
        CHECK_FALSE(contains(rock.outline, line.to));
        for (const Vec2& corner : rock.outline) CHECK((line.from - corner).norm() > 0.3);
    }
}

TEST_CASE("spacings have the mean and deviation asked for, within the limits of truncation") {
    JointSetSpec set = joint_set(20.0, 0.1);
    SECTION("normal") {
        set.spacing.deviation = 0.02;
        const Statistics s = statistics(spacings(set, 200.0));
        CHECK(s.mean == Approx(0.1).epsilon(0.02));
        CHECK(s.deviation == Approx(0.02).epsilon(0.05));
    }
    SECTION("uniform: no spacing beyond sqrt(3) deviations") {
        set.spacing = {0.1, 0.03, Distribution::uniform};
        const Statistics s = statistics(spacings(set, 200.0));
        CHECK(s.mean == Approx(0.1).epsilon(0.02));
        CHECK(s.deviation == Approx(0.03).epsilon(0.05));
        CHECK(s.most < 0.1 + 0.03 * std::sqrt(3.0) + 1e-9);
        CHECK(s.least > 0.1 - 0.03 * std::sqrt(3.0) - 1e-9);
    }
    SECTION("lognormal: mean and deviation are those of the spacing itself") {
        set.spacing = {0.1, 0.03, Distribution::lognormal};
        const Statistics s = statistics(spacings(set, 200.0));
        CHECK(s.mean == Approx(0.1).epsilon(0.02));
        CHECK(s.deviation == Approx(0.03).epsilon(0.05));
    }
    SECTION("exponential, truncated to [mean/5, 5 mean]: the mean rises by (1.2 e^-0.2 - 6 e^-5)/(e^-0.2 - e^-5)") {
        set.spacing = {0.1, 0.0, Distribution::exponential};
        const Statistics s = statistics(spacings(set, 200.0));
        const double raised = (1.2 * std::exp(-0.2) - 6.0 * std::exp(-5.0)) / (std::exp(-0.2) - std::exp(-5.0));
        CHECK(s.mean == Approx(0.1 * raised).epsilon(0.03));
        CHECK(s.least > 0.02 - 1e-9);
        CHECK(s.most < 0.5 + 1e-9);
    }
}

TEST_CASE("angles have the mean and deviation asked for, and none lies beyond three deviations") {
    JointSetSpec set = joint_set(30.0, 0.05);
    set.angle.deviation = radians(4.0);
    std::vector<double> angles;
    for (const CutLine& line : joint_set_lines(set, bounds(square(100.0)), 0))
        if (distance(line, {0, 0}) < 60.0) {  // there every line meets the square, whatever its angle
            const Vec2 along = line.to - line.from;
            angles.push_back(degrees(std::atan(along.y() / along.x())));
        }
    const Statistics s = statistics(angles);
    CHECK(angles.size() > 2000);
    CHECK(s.mean == Approx(30.0).margin(0.3));
    CHECK(s.deviation == Approx(4.0 * 0.9866).epsilon(0.05));  // a normal truncated at 3 deviations
    CHECK(s.least > 18.0 - 1e-9);
    CHECK(s.most < 42.0 + 1e-9);
}

TEST_CASE("persistence is the share of the joint lines that is cut, in pieces of the trace length") {
    JointSetSpec set = joint_set(0.0, 1.0);
    set.persistence = 0.7;
    set.trace_length = {3.0, 0.5, Distribution::normal};
    const double size = 300.0;
    double cut_length = 0.0, begun_in_gap = 0.0;
    std::vector<double> lengths;
    std::map<double, int> pieces_per_line;
    for (const CutLine& line : joint_set_lines(set, bounds(square(size)), 0)) {
        const double length = (line.to - line.from).norm();
        cut_length += length;
        const bool whole = std::abs(line.from.x()) < size && std::abs(line.to.x()) < size;
        if (whole) lengths.push_back(length);
        begun_in_gap += line.from.x() < 0.1 && line.to.x() > 0.1;
        ++pieces_per_line[line.from.y()];
    }
    const double lines = 2.0 * size + 1.0;
    CHECK(static_cast<double>(pieces_per_line.size()) == lines);
    CHECK(cut_length / (lines * 2.0 * size) == Approx(0.7).epsilon(0.005));
    CHECK(statistics(lengths).mean == Approx(3.0).epsilon(0.01));
    CHECK(statistics(lengths).deviation == Approx(0.5).epsilon(0.03));
    CHECK(begun_in_gap / lines == Approx(0.7).margin(0.06));  // phases are random: a column of points meets the same share
}

TEST_CASE("the same seed gives the same joints near the origin, however large the rock") {
    JointSetSpec set = joint_set(25.0, 1.0);
    set.spacing.deviation = 0.3;
    set.angle.deviation = radians(3.0);
    set.persistence = 0.6;
    set.trace_length = {2.0, 0.4, Distribution::lognormal};
    set.seed = 12;
    const auto small = joint_set_lines(set, bounds(square(10)), 0), large = joint_set_lines(set, bounds(square(25)), 0);
    CHECK(large.size() > 2 * small.size());
    int inner = 0;
    for (const CutLine& line : small) {
        if (std::max(line.from.cwiseAbs().maxCoeff(), line.to.cwiseAbs().maxCoeff()) > 9.999) continue;
        ++inner;
        CHECK(std::any_of(large.begin(), large.end(),
                          [&](const CutLine& l) { return l.from == line.from && l.to == line.to; }));
    }
    CHECK(inner > 50);

    set.seed = 13;
    CHECK(joint_set_lines(set, bounds(square(10)), 0)[0].from != small[0].from);
}

TEST_CASE("a further set, of whatever name, changes nothing in the others, and two sets with one seed differ") {
    RockSpec rock;
    rock.outline = square(10);
    JointSetSpec a = joint_set(10.0, 1.0);
    a.spacing.deviation = 0.2;
    JointSetSpec b = a;
    b.name = "cross";
    rock.joint_sets = {a};
    const auto alone = joint_lines(rock);
    rock.joint_sets = {b, a};
    auto both = joint_lines(rock);
    const auto first_of_a = std::find_if(both.begin(), both.end(), [](const CutLine& l) { return l.source == 1; });
    REQUIRE(static_cast<std::size_t>(both.end() - first_of_a) == alone.size());
    for (std::size_t i = 0; i < alone.size(); ++i) CHECK(first_of_a[static_cast<std::ptrdiff_t>(i)].from == alone[i].from);
    CHECK(both[1].from != alone[1].from);  // [0] is the line through the origin
}

TEST_CASE("joints of a set with `inside` stay in the polygon and cut it from side to side") {
    RockSpec rock;
    rock.outline = square(10);
    rock.joint_sets = {joint_set(33.0, 1.0)};
    rock.joint_sets[0].inside = {{-5.1, -5.3}, {5.2, -5.1}, {5.7, 4.9}, {-4.9, 5.3}};
    double length = 0.0;
    for (const CutLine& line : joint_lines(rock)) {
        length += (line.to - line.from).norm();
        CHECK(contains(rock.joint_sets[0].inside, (line.from + line.to) / 2.0));
    }
    CHECK(length == Approx(signed_area(rock.joint_sets[0].inside)).epsilon(0.02));  // one metre of joint per square metre

    CutInput input;
    input.outline = rock.outline;
    input.regions = {{rock.joint_sets[0].inside, 0}};
    input.lines = joint_lines(rock);
    const CutResult result = cut(input);
    CHECK(result.blocks.size() == input.lines.size() + 2);  // strips of the region, and the rest
}

TEST_CASE("sources count joint sets, then cracks, then the trace map") {
    RockSpec rock;
    rock.outline = square(10);
    rock.joint_sets = {joint_set(0.0, 100.0), joint_set(90.0, 100.0)};
    rock.cracks = {{{{-5, 3}, {5, 3}}, ""}, {{{-5, 4}, {5, 4}, {6, 7}}, ""}};
    rock.traces = TraceMapSpec{};
    rock.traces->lines = {{{1, 1}, {2, 2}}, {{3, 1}, {4, 2}}};
    std::vector<int> sources;
    for (const CutLine& line : joint_lines(rock)) sources.push_back(line.source);
    CHECK(std::is_sorted(sources.begin(), sources.end()));
    CHECK(std::set<int>(sources.begin(), sources.end()) == std::set<int>{0, 1, 2, 3, 4});
}

TEST_CASE("a crack that ends on the outline cuts it, also where the coordinates are rounded") {
    RockSpec rock;
    rock.outline = {{0, 0}, {3.3, 0.7}, {2.9, 3.1}, {-0.3, 2.7}};
    const auto on = [&](int edge, double t) { return Vec2(rock.outline[edge] * (1.0 - t) + rock.outline[edge + 1] * t); };
    for (const double t : {0.1, 0.2, 0.3, 0.7, 0.9}) {
        rock.cracks = {{{on(0, t), on(2, t)}, ""}};
        CutInput input;
        input.outline = rock.outline;
        input.lines = joint_lines(rock);
        CHECK(cut(input).blocks.size() == 2);
    }
}

TEST_CASE("traces are snapped to earlier corners and extended at tips that end at no other trace") {
    TraceMapSpec map;
    map.extend = 0.5;
    map.snap = 0.1;
    map.lines = {{{0, 0}, {2, 0}, {4, 0}},          // free at the left only, for the next one starts at its end
                 {{4.03, 0.04}, {4, 3}},            // free at the top
                 {{9, 9}, {9.05, 9}},               // shrinks to a point
                 {{6, 6}, {7, 6}, {7, 7}, {6, 6}},  // closed
                 {{1, -2}, {1, 0.02}}};             // free at the bottom, ends on the first one
    const TraceLines result = trace_lines(map, square(20), 0.0, 2);
    CHECK(result.corners_snapped == 2);
    CHECK(result.junctions == 1);
    CHECK(result.traces == 4);
    CHECK(result.tips_extended == 3);
    const std::vector<std::pair<Vec2, Vec2>> expected{{{-0.5, 0}, {0, 0}},  {{0, 0}, {1, 0.02}}, {{1, 0.02}, {2, 0}},
                                                      {{2, 0}, {4, 0}},     {{4, 0}, {4, 3}},    {{4, 3}, {4, 3.5}},
                                                      {{6, 6}, {7, 6}},     {{7, 6}, {7, 7}},    {{7, 7}, {6, 6}},
                                                      {{1, -2.5}, {1, -2}}, {{1, -2}, {1, 0.02}}};
    REQUIRE(result.lines.size() == expected.size());
    for (std::size_t i = 1; i < expected.size(); ++i) {
        CHECK((result.lines[i].from - expected[i].first).norm() < 1e-15);
        CHECK((result.lines[i].to - expected[i].second).norm() < 1e-15);
        CHECK(result.lines[i].source == 2);
    }
    CHECK((result.lines[0].from - (Vec2(0, 0) - 0.5 * Vec2(1, 0.02).normalized())).norm() < 1e-15);  // the bent segment
}

TEST_CASE("a trace that ends at a corner of another one ends there exactly, and no stub dangles behind it") {
    TraceMapSpec map;
    map.lines = {{{-20, 0}, {0.1, 0.3}, {20, 0}}, {{0.1, 0.3}, {0.7, 20}}};
    CutInput input;
    input.outline = square(10);
    input.lines = trace_lines(map, input.outline, 1e-6, 0).lines;
    const CutResult cut_through = cut(input);
    CHECK(cut_through.blocks.size() == 3);
    CHECK(cut_through.report.dangling == 0);
}

TEST_CASE("lines that share a tip part the rock there, whatever their directions") {
    // Where one of them turned back sharply, or went straight on, a rounding error was enough to pass beside the tip.
    const Vec2 tip(0.1, 0.3);
    for (int i = 0; i < 200; ++i) {
        const double a = 0.1 + 0.03 * i;
        const auto away = [&](double angle) { return Vec2(tip + 30.0 * Vec2(std::cos(angle), std::sin(angle))); };
        for (const double turn : {0.05, 3.0, 3.14159265358979}) {
            TraceMapSpec map;
            map.lines = {{away(a), tip}, {tip, away(a + turn)}};
            CutInput input;
            input.outline = square(10);
            input.lines = trace_lines(map, input.outline, 1e-8, 0).lines;
            CHECK(cut(input).blocks.size() == 2);
            map.lines = {{away(a - 0.05), tip, away(a + 0.05)}, {tip, away(a + turn)}};
            input.lines = trace_lines(map, input.outline, 1e-8, 0).lines;
            CHECK(cut(input).blocks.size() == (turn == 0.05 ? 2 : 3));
        }
    }
}

TEST_CASE("a trace drawn past a corner within `snap` is led through it, so that no sliver is left") {
    TraceMapSpec map;
    map.snap = 0.01;
    map.lines = {{{-20, 0}, {20, 0}},                            // a long trace,
                 {{3, 0.004}, {5, 4}, {20, 4}},                  // one that ends 4 mm beside it,
                 {{-8, -0.003}, {-2, 0.002}, {0, 3}, {0, 20}}};  // and one that follows it for a while
    const TraceLines result = trace_lines(map, square(10), 1e-8, 0);
    CHECK(result.junctions == 3);
    CHECK(result.corners_snapped == 0);
    CHECK(result.tips_extended == 0);  // by 1e-8 m only, which is not counted

    CutInput input;
    input.outline = square(10);
    input.lines = result.lines;
    const CutResult cut_through = cut(input);
    CHECK(cut_through.blocks.size() == 4);
    for (const CutBlock& block : cut_through.blocks) CHECK(block.area > 1.0);
}

TEST_CASE("corners of traces near a corner of the outline become that corner") {
    TraceMapSpec map;
    map.snap = 0.1;
    map.lines = {{{-9.95, -10.02}, {0, 0}, {9.98, 10}}};
    const TraceLines result = trace_lines(map, square(10), 0.0, 0);
    CHECK(result.corners_snapped == 2);
    CHECK(result.lines.front().from == Vec2(-10, -10));
    CHECK(result.lines.back().to == Vec2(10, 10));
}

TEST_CASE("sets that cannot be drawn are refused") {
    const Box box = bounds(square(10));
    JointSetSpec set = joint_set(10.0, 0.0);
    CHECK_THROWS_AS(joint_set_lines(set, box, 0), InputError);
    set.spacing.mean = 1e-7;
    CHECK_THROWS_AS(joint_set_lines(set, box, 0), InputError);
    set.spacing.mean = 1e-6 * 15;
    CHECK_THROWS_AS(joint_set_lines(set, box, 0), InputError);
    set = joint_set(10.0, 1.0);
    set.persistence = 0.5;
    CHECK_THROWS_AS(joint_set_lines(set, box, 0), InputError);
    set = joint_set(10.0, 1.0);
    set.angle = {1.0, 0.1, Distribution::exponential};
    CHECK_THROWS_AS(joint_set_lines(set, box, 0), InputError);
}
