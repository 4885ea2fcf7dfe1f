// The tangent of a contact against differences of its forces.
#include "contact/tangent.hpp"
#include "contact/contacts.hpp"
#include "dynamics/motion.hpp"
#include "model/part_boxes.hpp"
#include "support/catch.hpp"
#include "support/hand_made.hpp"

#include <array>
#include <functional>

using namespace talus;

namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;

// Two blocks and their contact; blocks are moved, and their contact lives through one step of the law.
class PairOfBlocks {
public:
    explicit PairOfBlocks(Model model) : model_(std::move(model)), state_(test::at_rest(model_)) {
        place(model_, all_awake(2), state_.motion, 0.1, placed_);
        std::vector<Box> boxes;
        std::vector<std::uint8_t> reboxed;
        rebox(model_, state_, 0.1, placed_, boxes, reboxed);
        const std::vector<Pair> pairs{{0, 1}};
        refresh_contacts(model_, placed_, pairs, reboxed, 0.1, state_, index_);
    }

    void move(const Vector6& by) {
        for (BlockId b : {0, 1}) {
            state_.motion.velocity[b] = by.segment<2>(3 * b);
            state_.motion.spin[b] = by[3 * b + 2];
        }
        drift(all_awake(2), state_.motion, 1.0);
        place(model_, all_awake(2), state_.motion, 0.1, placed_);
        update_contacts(model_, placed_, 1.0, Pace::all, state_, index_);
    }

    Vector6 forces() const {
        const Reaction& r = state_.contacts.reaction.front();
        Vector6 all;
        all << -r.force, r.torque_a, r.force, r.torque_b;
        return all;
    }
    const Contact& contact() const { return state_.contacts.list.front(); }
    Tangent tangent() const {
        return contact_tangent(model_, placed_, state_.contacts.broken, contact(), state_.contacts.reaction.front());
    }
    Vec2 distance() const { return state_.motion.position[1] - state_.motion.position[0]; }

private:
    Model model_;
    State state_;
    Placed placed_;
    ContactIndex index_;
};

Vector6 by(double ax, double ay, double at, double bx, double by, double bt) {
    Vector6 v;
    v << ax, ay, at, bx, by, bt;
    return v;
}

// Central differences would see both sides of stick and slip: each column is taken on the side on which the contact goes on
// doing what it does.
Matrix6 differences(const PairOfBlocks& at, double step) {
    Matrix6 k;
    for (int i = 0; i < 6; ++i) {
        Matrix6 unit = Matrix6::Identity();
        double best = 1e300;
        for (const double side : {step, -step}) {
            PairOfBlocks moved = at;
            moved.move(side * unit.col(i));
            if (moved.contact().sliding != at.contact().sliding) continue;
            const Vector6 column = -(moved.forces() - at.forces()) / side;
            const double error = (column - at.tangent().stiffness.col(i)).norm();
            if (error < best) best = error, k.col(i) = column;
        }
        REQUIRE(best < 1e300);
    }
    return k;
}

void check(const PairOfBlocks& at, double tolerance, double step = 1e-9) {
    REQUIRE(at.contact().touching);
    const Matrix6 tangent = at.tangent().stiffness, measured = differences(at, step);
    INFO("tangent\n" << tangent << "\nmeasured\n" << measured);
    CHECK((tangent - measured).norm() < tolerance * measured.norm());
}

Model two_squares(double friction_deg, double x = 0.0, double angle = 0.0) {
    Polygon upper = test::rectangle(0.0, 0.0, 1.0, 1.0);
    for (Vec2& p : upper)
        p = Vec2(std::cos(angle) * p.x() - std::sin(angle) * p.y() + x,
                 std::sin(angle) * p.x() + std::cos(angle) * p.y() + 1.0);
    Model m = test::blocks_of_parts({{test::rectangle(0, 0, 1.5, 1)}, {upper}});
    m.joints = {Joint{}};
    Joint& joint = m.joints.front();
    joint.kn = 1e9, joint.ks = 4e8;
    joint.tan_friction = joint.tan_friction_residual = std::tan(radians(friction_deg));
    joint.name = "joint";
    m.blocks.radius = {1.0, 1.0};
    return m;
}

constexpr double u = 1e-5;  // m, overlap: 1e-5 of the length, which is what the tangent leaves out

}  // namespace

TEST_CASE("the tangent of a face that sticks is that of its springs") {
    PairOfBlocks pair(two_squares(40.0));
    pair.move(by(0, 0, 0, 0, -u, 0));
    pair.move(by(0, 0, 0, 0.3 * u, 0, 0.2 * u));
    REQUIRE_FALSE(pair.contact().sliding);
    check(pair, 1e-4);
    CHECK(pair.tangent().symmetric);
    CHECK(pair.tangent().stiffness(4, 4) == Approx(1e9).epsilon(1e-4));  // kn L
    CHECK(pair.tangent().stiffness(3, 3) == Approx(4e8).epsilon(1e-4));  // ks L
}

TEST_CASE("the tangent of a face that slides follows the normal force") {
    PairOfBlocks pair(two_squares(20.0));
    pair.move(by(0, 0, 0, 0, -u, 0));
    for (const double way : {1.0, -3.0}) {
        pair.move(by(0, 0, 0, 3 * way * u, 0, 0.1 * u));
        REQUIRE(pair.contact().sliding);
        CHECK_FALSE(pair.tangent().symmetric);
        check(pair, 1e-4);
    }
}

TEST_CASE("the tangent of a face that is partly open knows how its length changes") {
    for (const double friction_deg : {45.0, 10.0}) {
        PairOfBlocks pair(two_squares(friction_deg));
        pair.move(by(0, 0, 0, 0, -u, 0));
        pair.move(by(0, 0, 0, 1.0 * u, 0, 4.0 * u));
        CAPTURE(friction_deg, pair.contact().length);
        REQUIRE(pair.contact().length < 0.9);
        REQUIRE(pair.contact().sliding == (friction_deg < 20.0));
        check(pair, 1e-3);
    }
}

TEST_CASE("the tangent of a corner is that of the distance potential") {
    for (const double friction_deg : {45.0, 5.0}) {
        PairOfBlocks pair(two_squares(friction_deg, 0.7, radians(30.0)));
        pair.move(by(0, 0, 0, 0, -100 * u, 0));
        pair.move(by(0, 0, 0, 20 * u, 0, 1e-4));
        REQUIRE(pair.contact().edge_a < 0);
        check(pair, 2e-2);
    }
}

TEST_CASE("the tangent of a joint that dilates counts the lift of the slip") {
    Model model = two_squares(30.0);
    model.joints.front().tan_dilation = std::tan(radians(8.0));
    PairOfBlocks pair(model);
    pair.move(by(0, 0, 0, 0, -u, 0));
    pair.move(by(0, 0, 0, 4 * u, 0, 0));
    REQUIRE(pair.contact().sliding);
    check(pair, 1e-3, 1e-7);  // the lift acts half a lift lower in the step that makes it: a jump of the torque by 1e-11 N m
}

TEST_CASE("the force of a contact turns with its blocks") {
    PairOfBlocks pair(two_squares(40.0));
    pair.move(by(0, 0, 0, 0, -u, 0));
    pair.move(by(0, 0, 0, 0.3 * u, 0, 0));
    // Both blocks turned as one body by a small angle about the centroid of the first one.
    const Vec2 d = pair.distance();
    const Vector6 turn = by(0, 0, 1, -d.y(), d.x(), 1);
    const Vector6 change = -pair.tangent().stiffness * turn, forces = pair.forces();
    const double size = forces.norm();
    CHECK((change.segment<2>(3) - perp(forces.segment<2>(3))).norm() < 1e-3 * size);
    CHECK(std::abs(change[2]) + std::abs(change[5]) < 1e-3 * size);
}
