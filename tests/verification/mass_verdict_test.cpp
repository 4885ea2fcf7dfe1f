// What is said of masses of many blocks, against limit equilibrium: columns, planes, wedges, roofs, walls, round slips, in
// several scales and with every solver that applies.
#include "scenario/reader.hpp"
#include "simulation/run.hpp"
#include "support/catch.hpp"

#include <cmath>
#include <functional>
#include <sstream>
#include <vector>

using namespace talus;

namespace {

using Points = std::vector<Vec2>;

/// Blocks in units of `scale` (m); gravity leans down-slope, to +x, by `slope_deg`.
class Mass {
public:
    Mass(double scale, double slope_deg, double closed = 1e-5) : scale_(scale), slope_(radians(slope_deg)) {
        blocks_.precision(17);
        stiffness_ = 2500.0 * 9.81 / closed;  // Pa/m: under a column of one unit a joint closes this share of it
    }
    void add(const std::string& name, const Points& outline, bool held = false) {
        blocks_ << "  - {name: " << name << " " << ++count_ << ", outline: [";
        for (const Vec2& p : outline)
            blocks_ << (&p == &outline.front() ? "[" : ", [") << p.x() * scale_ << ", " << p.y() * scale_ << "]";
        blocks_ << (held ? "], held: true}\n" : "]}\n");
    }
    void box(const std::string& name, double x, double y, double w, double h, bool held = false) {
        add(name, {{x, y}, {x + w, y}, {x + w, y + h}, {x, y + h}}, held);
    }
    std::string text(double friction_deg, const std::string& run) const {
        std::ostringstream all;
        all.precision(17);
        all << "title: mass\ngravity: [" << 9.81 * std::sin(slope_) << ", " << -9.81 * std::cos(slope_) << "]\n"
            << "materials: {rock: {density: 2500}}\njoints: {joint: {normal_stiffness: " << stiffness_
            << ", shear_stiffness: " << 0.5 * stiffness_ << ", friction_angle_deg: " << friction_deg << "}}\nblocks:\n"
            << blocks_.str() << run;
        return all.str();
    }
    /// Gravity acts at once, without springs.
    StabilityVerdict rigid(double friction_deg, double time = 60.0) const {
        return told(text(friction_deg, "run: {solver: rigid, until: {verdict: true, time: " + number(time) + "}}\n"));
    }
    /// Settled with rough joints, which then lose their friction; contacts are damped, for a mass that rings creeps.
    StabilityVerdict sprung(double friction_deg, double damping = 3e-3) const {
        const double fall = std::sqrt(scale_ / 9.81);
        const std::string damped = "damping: {contact: " + number(damping * std::sqrt(scale_)) + "}";
        std::ostringstream stages;
        stages << "stages:\n  - {settle: true, until: {time: " << 200.0 * fall << ", equilibrium: 1e-6}}\n"
               << "  - {" << damped << ", change: {joints: {joint: {friction_angle_deg: " << friction_deg
               << "}}}, until: {time: " << 1e-3 * fall << "}}\nrun: {" << damped << ", until: {verdict: true, time: 60}}\n";
        return told(text(60.0, stages.str()));
    }
    StabilityVerdict by_statics(double friction_deg) const {
        return told(text(friction_deg, "run: {solver: static, until: {equilibrium: 1e-4}}\n"));
    }

private:
    static std::string number(double value) {
        std::ostringstream text;
        text.precision(17);
        text << value;
        return text.str();
    }
    static StabilityVerdict told(const std::string& text) {
        const Scenario scenario = read_scenario_text(text, "test.yaml", ".");
        Simulation simulation(scenario, build(scenario));
        run(simulation, {});
        return simulation.verdict();
    }
    double scale_, slope_, stiffness_;
    int count_ = 0;
    std::ostringstream blocks_;
};

/// m2 of blocks whose mechanism is one of these, over the area of all that move.
double share_of(const StabilityVerdict& v, const std::vector<Mechanism>& these) {
    int found = 0;
    for (const Mechanism m : v.block_mechanism) found += std::ranges::count(these, m) > 0;
    return v.moving_blocks > 0 ? static_cast<double>(found) / v.moving_blocks : 0.0;
}

// The example of Goodman & Bray (1976): sixteen columns of 10 m on a base that dips 30 degrees and steps by 1 m; slope of
// 56.6 degrees, 92.5 m high. Its friction at the limit is 38.15 degrees: columns 1 to 3 at the toe slide, 4 to 13 topple, 14
// to 16 stand.
Mass columns(double scale) {
    Mass s(scale, 30.0);
    const auto height = [](int n) { return n <= 10 ? 0.4 * n : 4.0 - 0.62 * (n - 10); };
    for (int n = 1; n <= 16; ++n) s.box("base", -n, -1.0, 1.0, 1.0 + 0.1 * n, true);
    s.box("foot", 0.0, -1.0, 30.0, 0.9, true);
    s.box("behind", -18.0, -1.0, 2.0, 4.0, true);
    for (int n = 1; n <= 16; ++n) s.box("column", -n, 0.1 * n, 1.0, height(n));
    return s;
}

// Wide slabs on a plane of 35 degrees, which slide and cannot topple.
Mass slabs(double scale, int long_, int high) {
    Mass s(scale, 35.0);
    s.box("plane", -20.0, -1.0, 600.0, 1.0, true);
    for (int row = 0; row < high; ++row)
        for (int i = 0; i < long_; ++i) s.box("slab", 2.0 * high * i, row, 2.0 * high, 1.0);
    return s;
}

// Two masses in slices on two planes, 50 and 20 degrees steep. The joint between them is vertical and lies above the knee,
// so that both can slide.
struct TwoPlanes {
    double upper = radians(50.0), lower = radians(20.0), from = 2.0, to = 10.0, reach = 12.0, height = 5.0;
    Vec2 on_upper(double d) const { return {-d * std::cos(upper), d * std::sin(upper)}; }
    Vec2 on_lower(double d) const { return {d * std::cos(lower), -d * std::sin(lower)}; }
    Vec2 joint_top() const { return on_upper(from) + Vec2(0.0, height); }
    double upper_area() const { return 0.5 * height * (to - from) * std::cos(upper); }
    double lower_area() const {  // knee, joint, end
        const Vec2 a = on_upper(from), b = joint_top(), c = on_lower(reach);
        return 0.5 * std::abs(cross(c, b) + cross(b, a));
    }
    /// What the upper mass pushes with, less what the lower one holds, both along their planes turned by friction; friction
    /// acts in full on both planes and on the joint.
    double excess(double friction) const {
        const double push = upper_area() * std::sin(upper - friction) / std::cos(upper - 2.0 * friction);
        return push * std::cos(lower - 2.0 * friction) - lower_area() * std::sin(friction - lower);
    }
    double limit_deg() const {
        double low = lower, high = upper;
        for (int i = 0; i < 60; ++i) (excess(0.5 * (low + high)) > 0.0 ? low : high) = 0.5 * (low + high);
        return degrees(low);
    }
    Mass scene(double scale, int slices) const {
        Mass s(scale, 0.0);
        s.add("upper plane", {{-30.0, -30.0}, {0.0, -30.0}, {0.0, 0.0}, on_upper(20.0), {-30.0, on_upper(20.0).y()}}, true);
        s.add("lower plane", {{0.0, -30.0}, {on_lower(60.0).x(), -30.0}, on_lower(60.0), {0.0, 0.0}}, true);
        const auto top = [](const Vec2& a, const Vec2& b, double x) {
            return Vec2(x, a.y() + (b.y() - a.y()) * (x - a.x()) / (b.x() - a.x()));
        };
        const Vec2 crest = on_upper(to), toe = on_lower(reach);
        for (int i = 0; i < slices; ++i) {
            const double step = (to - from) / slices;
            const Vec2 right = on_upper(from + i * step), left = on_upper(from + (i + 1) * step);
            Points outline{left, right, top(joint_top(), crest, right.x())};
            if (i + 1 < slices) outline.push_back(top(joint_top(), crest, left.x()));
            s.add("upper", outline);
        }
        for (int i = 0; i < slices; ++i) {
            const Vec2 left = i == 0 ? on_upper(from) : on_lower(reach * i / slices),
                       right = on_lower(reach * (i + 1) / slices);
            Points outline{left};
            if (i == 0) outline.emplace_back(0.0, 0.0);
            outline.push_back(right);
            if (i + 1 < slices) outline.push_back(top(joint_top(), toe, right.x()));
            outline.push_back(top(joint_top(), toe, left.x()));
            s.add("lower", outline);
        }
        return s;
    }
};

// A roof of layers between two walls that lean apart by `opening_deg` each, downwards if positive; all hangs over a cavern.
Mass roof(double scale, double opening_deg, int layers) {
    Mass s(scale, 0.0);
    const double high = 2.0, lean = std::tan(radians(opening_deg));
    const auto x = [&](double y) { return 1.0 + lean * (high - y); };
    s.add("left", {{-9.0, 0.0}, {-x(0.0), 0.0}, {-x(high), high}, {-9.0, high}}, true);
    s.add("right", {{x(0.0), 0.0}, {9.0, 0.0}, {9.0, high}, {x(high), high}}, true);
    s.box("above", -9.0, high, 18.0, 1.0, true);
    s.box("floor", -9.0, -30.0, 18.0, 1.0, true);
    for (int i = 0; i < layers; ++i) {
        const double y = high * i / layers, z = high * (i + 1) / layers;
        s.add("layer", {{-x(y), y}, {x(y), y}, {x(z), z}, {-x(z), z}});
    }
    return s;
}

Mass wall(double scale, double tilt_deg, int courses) {
    Mass s(scale, tilt_deg);
    s.box("ground", -20.0, -1.0, 60.0, 1.0, true);
    for (int i = 0; i < courses; ++i) s.box("course", 0.0, i, 3.0, 1.0);
    return s;
}

// A round trough of radius 10 in two-degree steps, and in it a mass of rings and sectors that lies askew.
Mass trough(double scale, int rings) {
    Mass s(scale, 0.0);
    const auto at = [](double radius, double angle_deg) {
        return Vec2(radius * std::cos(radians(angle_deg)), radius * std::sin(radians(angle_deg)));
    };
    for (int a = -180; a < 0; a += 2) s.add("trough", {at(10, a), at(11, a), at(11, a + 2), at(10, a + 2)}, true);
    for (int ring = 0; ring < rings; ++ring)
        for (int a = -80; a < -20; a += 10) {
            const double inner = 10.0 - 4.0 * (ring + 1) / rings, outer = 10.0 - 4.0 * ring / rings;
            Points outline;
            for (int k = a; k <= a + 10; k += 2) outline.push_back(at(outer, k));
            for (int k = a + 10; k >= a; k -= 2) outline.push_back(at(inner, k));
            s.add("mass", outline);
        }
    return s;
}

}  // namespace

TEST_CASE("columns topple, push their toe out, and leave the rock behind, as Goodman and Bray say, in every scale") {
    for (const double scale : {0.01, 10.0, 100.0}) {
        const Mass slope = columns(scale);
        const StabilityVerdict stands = slope.rigid(39.0), falls = slope.rigid(37.0);
        CAPTURE(scale, stands.reason, falls.reason, name_of(falls.mechanism));
        CHECK(stands.verdict == Stability::stable);
        CHECK(falls.verdict == Stability::unstable);
        CHECK(falls.mechanism == Mechanism::topple);
        CHECK(falls.moving_blocks == 13);
        for (int n = 1; n <= 16; ++n) {
            const Mechanism m = falls.block_mechanism[static_cast<std::size_t>(17 + n)];
            CAPTURE(n, name_of(m));
            if (n <= 3) CHECK((m == Mechanism::slide || m == Mechanism::slide_and_topple));
            if (n > 3 && n <= 13) CHECK(m == Mechanism::topple);
            if (n > 13) CHECK(m == Mechanism::none);
        }
    }
}

TEST_CASE("springs and the static solver come to the same verdict on columns that topple") {
    const Mass slope = columns(10.0);
    CHECK(slope.sprung(39.0).verdict == Stability::stable);
    const StabilityVerdict falls = slope.sprung(36.0);
    CAPTURE(falls.reason, name_of(falls.mechanism));
    CHECK(falls.verdict == Stability::unstable);
    CHECK(falls.mechanism == Mechanism::topple);
    CHECK(falls.moving_blocks == 13);
    CHECK(slope.by_statics(39.0).verdict == Stability::stable);
    CHECK(slope.by_statics(36.0).verdict == Stability::unstable);
    // Far below the limit the columns come to rest on each other further down: a state of balance, but not that of the
    // slope.
    const StabilityVerdict far = slope.by_statics(33.0);
    CAPTURE(far.reason);
    CHECK(far.verdict == Stability::unstable);
}

TEST_CASE("slabs slide on a plane that is steeper than friction, and stand on one that is not") {
    for (const double scale : {0.01, 1.0, 100.0})
        for (const auto& [long_, high] : std::vector<std::pair<int, int>>{{50, 1}, {25, 2}, {10, 5}}) {
            const Mass slope = slabs(scale, long_, high);
            const StabilityVerdict slides = slope.rigid(34.0), stands = slope.rigid(36.0);
            CAPTURE(scale, long_, high, slides.reason, stands.reason);
            CHECK(stands.verdict == Stability::stable);
            CHECK(slides.verdict == Stability::unstable);
            CHECK(slides.mechanism == Mechanism::slide);
            CHECK(slides.moving_blocks == 50);
        }
    const Mass slope = slabs(1.0, 25, 2);
    for (const StabilityVerdict& slides : {slope.sprung(33.0), slope.by_statics(20.0)}) {
        CAPTURE(slides.reason);
        CHECK(slides.verdict == Stability::unstable);
        CHECK(slides.mechanism == Mechanism::slide);
        CHECK(slides.moving_blocks == 50);
    }
    CHECK(slope.sprung(36.0).verdict == Stability::stable);
    CHECK(slope.by_statics(36.0).verdict == Stability::stable);
}

TEST_CASE("a mass on a steep plane pushes one on a gentle plane out, when friction is below that of limit equilibrium") {
    const TwoPlanes wedge;
    const double limit = wedge.limit_deg();
    CAPTURE(limit);
    for (const int slices : {1, 3}) {
        const Mass slope = wedge.scene(1.0, slices);
        for (const StabilityVerdict& slides : {slope.rigid(limit - 5.0), slope.sprung(limit - 5.0)}) {
            CAPTURE(slices, slides.reason, name_of(slides.mechanism));
            CHECK(slides.verdict == Stability::unstable);
            CHECK(slides.mechanism == Mechanism::slide);
            CHECK(slides.moving_blocks == 2 * slices);
        }
        // Nearer to the limit it comes to rest when the upper mass has gone down from its plane.
        CHECK(slope.rigid(limit - 1.0).max_displacement > 1.0);
        for (const StabilityVerdict& stands :
             {slope.rigid(limit + 1.0), slope.sprung(limit + 1.0), slope.by_statics(limit + 1.0)}) {
            CAPTURE(slices, stands.reason);
            CHECK(stands.verdict == Stability::stable);
            CHECK(stands.max_displacement < 0.01);
        }
    }
}

TEST_CASE("what hangs between walls that lean apart downwards falls; between walls that lean together it stays") {
    for (const double scale : {0.01, 1.0, 100.0})
        for (const int layers : {1, 6}) {
            for (const double opening : {10.0, 0.0}) {
                const StabilityVerdict falls = roof(scale, opening, layers).rigid(30.0);
                CAPTURE(scale, layers, opening, falls.reason, name_of(falls.mechanism));
                CHECK(falls.verdict == Stability::unstable);
                CHECK(falls.mechanism == Mechanism::fall);
                CHECK(falls.moving_blocks == layers);
                CHECK(share_of(falls, {Mechanism::fall}) == 1.0);
            }
            const StabilityVerdict stays = roof(scale, -10.0, layers).rigid(30.0);
            CAPTURE(scale, layers, stays.reason);
            CHECK(stays.verdict == Stability::stable);
        }
}

TEST_CASE("a wall of loose courses overturns as one when its weight leaves its base") {
    for (const int courses : {6, 30}) {
        const double limit = degrees(std::atan(3.0 / courses));
        for (const double scale : {0.02, 2.0}) {
            const StabilityVerdict stands = wall(scale, limit - 0.3, courses).rigid(45.0),
                                   overturns = wall(scale, limit + 0.3, courses).rigid(45.0);
            CAPTURE(scale, courses, stands.reason, overturns.reason, name_of(overturns.mechanism));
            CHECK(stands.verdict == Stability::stable);
            CHECK(overturns.verdict == Stability::unstable);
            CHECK(overturns.mechanism == Mechanism::topple);
            CHECK(overturns.moving_blocks == courses);
            CHECK(share_of(overturns, {Mechanism::topple}) == 1.0);
        }
    }
}

TEST_CASE("a mass of many blocks rotates as one in a round trough") {
    for (const int rings : {1, 4}) {
        const StabilityVerdict found = trough(1.0, rings).rigid(5.0);
        CAPTURE(rings, found.reason, name_of(found.mechanism));
        CHECK(found.verdict == Stability::unstable);
        CHECK(found.mechanism == Mechanism::rotation);
        CHECK(found.moving_blocks == 6 * rings);
    }
}

TEST_CASE("a chip that comes off is counted, and does not make the mass unstable") {
    for (const double size : {0.03, 0.5}) {
        Mass slope = slabs(1.0, 25, 2);
        slope.box("chip", 30.0, 10.0, size, size);  // above the slabs: it falls on them
        const StabilityVerdict stands = slope.rigid(36.0);
        const double share = size * size / (200.0 + size * size);
        CAPTURE(size, stands.reason);
        CHECK(stands.verdict == (share < 0.001 ? Stability::stable : Stability::unstable));
        CHECK(stands.moving_blocks == 1);
        CHECK(stands.moving_share == Approx(share));
        CHECK(stands.mechanism == (share < 0.001 ? Mechanism::none : Mechanism::fall));
        CHECK(stands.block_mechanism.back() == Mechanism::fall);
        const StabilityVerdict slides = slope.rigid(30.0);
        CAPTURE(slides.reason);
        CHECK(slides.verdict == Stability::unstable);
        CHECK(slides.mechanism == Mechanism::slide);
        CHECK(slides.moving_blocks == 51);
    }
}
