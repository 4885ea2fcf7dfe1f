// From the list of contacts to what the solver of impulses works on, and back.
#pragma once

#include "model/placed.hpp"
#include "rigid/bodies.hpp"
#include "rigid/manifold.hpp"

namespace talus::rigid {

/// All touches of one step. `velocity` of the bodies in each call is that of the moment the name says.
class Touches {
public:
    /// Looks at every pair of the contact list whose blocks belong to different bodies, whose velocities hold weight and
    /// loads but no contacts; `before`: at the start of the step. Impulses of the step before are taken over (dt times the
    /// forces of the list). `fall`: m, how far blocks fall within a step; what is nearer counts as touching (if the block
    /// does fall, for what carried it before), or gaps of that size would close and open for ever. `rebounds`: some joint
    /// has a restitution.
    void find(const Model& model, const Placed& placed, const State& state, const Bodies& bodies,
              std::span<const Velocity> before, bool rebounds, double fall, double dt);

    /// Whether a block moves faster after the impacts than was known when touches were looked for, and so may have come to
    /// others; the next `find` looks as far as these speeds reach too, until they are forgotten.
    bool outrun(const Model& model, const Placed& placed, const Bodies& bodies);
    void forget_speeds() { seen_.clear(); }
    double fastest_seen() const;  // m/s

    /// The two parts that lie deepest in each other, for the size of the thinner one, of those that `find` looked at.
    struct Deepest {
        int slot = -1;       // in the contact list, -1 = no two
        double depth = 0.0;  // m
        double share = 0.0;  // of the thickness
    };
    const Deepest& deepest() const { return deepest_; }

    /// m/s, no point of any block is faster: twice the way of half a step is how far apart two may be to matter in it.
    /// `rebounds`: nor after an impact that turns the motion of its body into any other of the same energy.
    static double fastest(const Model& model, const Motion& motion, const Bodies& bodies, bool rebounds = false);

    std::span<Touch> list() { return touches_; }
    std::span<const Touch> list() const { return touches_; }

    /// Moves the bodies so that what presses lies on each other and nothing overlaps (`after`: velocities with the
    /// impulses, `before`: at the start of the step); writes the displacements, and returns false if there is nothing to
    /// do: no gap or overlap is larger than `exact` (m).
    bool correct(const Bodies& bodies, std::span<const Velocity> before, std::span<const Velocity> after, double exact,
                 double dt, std::vector<Velocity>& displacement);

    /// Writes forces, slip and places into the contact list; adds what friction and impacts took to the ledger.
    /// `displacement`: what `correct` found, empty if nothing.
    void record(const Model& model, const Placed& placed, const Bodies& bodies, std::span<const Velocity> before,
                std::span<const Velocity> after, std::span<const Velocity> displacement, double dt, double resolution,
                State& state) const;

    /// Adds the forces of all contacts, on each block about its centroid.
    void add_forces(const Model& model, const Placed& placed, const State& state, double dt, std::span<Force> sum) const;

    void forget_hints() { hint_.clear(); }  // the contact list has been renewed

    /// Adds to the impulses that were found those that acted before an impact. `resolution`: m/s, what changes a velocity by
    /// less presses nothing: of two walls that leave a block some room, rounding would have it lie on both.
    void add_earlier(double resolution);

    /// J, with which ends that have a restitution came down faster than `speed` (m/s) later in this step than another impact
    /// of their body (by more than the share `together` of it). Their impulses are guesses: those that were seen coming
    /// bounce as if nothing had been before, the others are stopped.
    double energy_of_later_landings(const Bodies& bodies, std::span<const Velocity> before, double speed, double together,
                                    double dt) const;

    /// Those that were not seen coming take part in the impact of their body, u >= -e u_before: nothing is lost by the
    /// guess. False if there are none; else impulses have to be found again.
    bool land_together(const Bodies& bodies, std::span<const Velocity> before, double speed, double dt);

    /// m, m, rad, after the impulses were found: by how much a body goes further in this step than with the mean of its
    /// velocities before and after, for an impact that is not in the middle of it.
    Velocity uneven_way(const Bodies& bodies, std::span<const Velocity> before, int body, double dt) const;

private:
    Manifold look_at(const Model& model, const Placed& placed, const Contact& c, const Bodies& bodies,
                     std::span<const Velocity> before, double dt, int& hint) const;
    bool moved_by_impact(const Bodies& bodies, int body) const;  // in this step
    double impact_of(const Bodies& bodies, int body) const;  // share of the step before it is moved by one; above 1: none
    void find_turns(const State& state, std::span<const Velocity> before);
    double share_of_fall(const Model& model, const State& state, const Bodies& bodies, std::size_t touch) const;
    void judge_ends(const Model& model, const State& state, const Bodies& bodies, std::span<const Velocity> before,
                    double fall, double dt);
    void find_impacts(const Bodies& bodies, std::span<const Velocity> before, double dt);
    /// As slender blocks will move if what carried them in the step before does so in this one, and all others without it.
    std::span<const Velocity> ahead_of_contacts(std::size_t touch, const Bodies& bodies) const {
        return slow_[touch] < 1.0 ? carried_ : bodies.velocity;
    }
    bool overtakes(std::size_t touch, int end, const Bodies& bodies, std::span<const Velocity> before, double dt) const;
    void find_uneven(const Bodies& bodies, std::span<const Velocity> before);
    void take_to_time_of_impact(const Bodies& bodies, std::span<const Velocity> before, double exact, double dt,
                                std::span<Velocity> displacement) const;

    struct Uneven {       // of a body with an impact
        Velocity gained;  // m/s, rad/s: f g - (1 - f) l of uneven_way
        bool bounces = false;
    };
    enum class End : std::uint8_t { meets, comes_near, bounces };

    Deepest deepest_;
    std::vector<Touch> touches_;
    std::vector<Manifold> manifold_;     // [touches]
    std::vector<double> rebound_;        // [touches] restitution
    std::vector<Vec2> from_a_;           // [touches] m, centroid of block a from that of its body
    std::vector<End> end_;               // [2 touches] what becomes of it in this step
    std::vector<double> slow_;           // [touches] of free fall, with which slender blocks rock; 1: not slender
    std::vector<double> near_;           // [2 touches] m, how far it falls in a step: what is nearer touches
    std::vector<Velocity> carried_;      // [nq] with weight, loads and the contacts of the step before
    std::vector<double> landed_;         // [2 touches] m, gap of an end that bounces at the end of the step
    std::vector<double> hit_;            // [2 touches] share of the step before it hits; above 1: it does not
    std::vector<double> ahead_;          // [touches] s, after the middle of the step: when it hits, 0 = it does not
    std::vector<double> impact_;         // [nq] share of the step before the first impact; above 1: none
    std::vector<Uneven> uneven_;         // [nq]
    std::vector<Velocity> gained_;       // [nq] by what acted before the impact
    std::vector<std::uint8_t> pressed_;  // [2 touches] an end that presses after the step
    std::vector<int> slot_;              // [touches] in the contact list
    std::vector<int> hint_;              // [contacts] see find_manifold
    std::vector<Manifold> found_;        // [contacts]
    std::vector<double> speed_;          // [nb] m/s
    std::vector<double> seen_;           // [nb] m/s, after impacts; empty = nothing
};

}  // namespace talus::rigid
