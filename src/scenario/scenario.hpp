// What a scenario file says, after every check and with every default filled in. Plain data in SI units; angles of keys that
// end in _deg are radians here. Coordinates are relative to `origin`, which was subtracted exactly when the file was read.
// Member names follow the keys of the file (docs/scenario-reference.md); absent things are empty.
#pragma once

#include "core/errors.hpp"
#include "core/time_table.hpp"
#include "core/types.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace talus {

struct VectorTable {  // [ax, ay], or {time: [...], x: [...], y: [...]}
    TimeTable x, y;
    Vec2 operator()(double t) const { return {x(t), y(t)}; }
};

struct MaterialSpec {
    std::string name;
    double density = 0.0;  // kg/m3
};

struct ResidualSpec {                             // strength after the first slip or break
    double friction_angle = 0.0, cohesion = 0.0;  // rad, Pa
};

struct JointSpec {
    std::string name;
    Where where;
    double normal_stiffness = 0.0, shear_stiffness = 0.0;        // Pa/m; 0: left to the accuracy
    double friction_angle = 0.0, cohesion = 0.0, tension = 0.0;  // rad, Pa, Pa
    double dilation_angle = 0.0;                                 // rad
    std::optional<double> dilation_cutoff_slip;                  // m, no dilation beyond this slip
    std::optional<double> restitution;                           // of the speed of approach; rigid solver only
    std::optional<ResidualSpec> residual;                        // absent: strength does not weaken by slip
    int cells = 2;                                               // bond cells per joint face
};

/// Which joint acts where; a named pair of blocks goes before a joint set, a joint set before a pair of materials, and
/// those before the default.
struct ContactSpec {
    std::string default_joint;
    struct Between {
        std::string a, b, joint;
    };
    std::vector<Between> materials, blocks;
};

enum class Distribution { normal, uniform, lognormal, exponential };

struct Spread {  // a number, or {mean, deviation, distribution}
    double mean = 0.0, deviation = 0.0;
    Distribution distribution = Distribution::normal;
};

struct JointSetSpec {
    std::string name;            // default: set1, set2, ...
    Spread angle;                // rad, counter-clockwise from +x
    Spread spacing;              // m, measured across the set
    double persistence = 1.0;    // (0, 1]: share of a joint line that is cut
    Spread trace_length;         // m, of the cut pieces, when persistence < 1
    Vec2 origin = Vec2::Zero();  // a point that one joint line passes through
    std::uint64_t seed = 0;
    std::string joint;  // empty: by materials
    Polygon inside;     // empty: everywhere in the outline
};

struct CrackSpec {  // one given polyline
    std::vector<Vec2> points;
    std::string joint;
};

struct TraceMapSpec {                      // mapped traces from a GeoJSON or CSV file
    std::string file;                      // relative to the scenario file
    std::vector<std::vector<Vec2>> lines;  // m, the polylines read from it
    double extend = 0.0;                   // m, added at the tips of traces that end at no other trace
    double snap = 0.0;                     // m, corners closer than this become one, traces passing by are led through
    std::string joint;
    Where where;
};

struct RegionSpec {  // cut out along its outline; blocks inside can be named by stages, materials and joints
    std::string name;
    Polygon outline;
    std::string material;  // empty: that of the rock
};

enum class SideSupport { none, held, roller };

struct HeldSpec {
    SideSupport left = SideSupport::none, right = SideSupport::none, bottom = SideSupport::none, top = SideSupport::none;
    std::optional<double> below, above;  // y in m: every block that reaches beyond this line is held
    std::vector<Polygon> inside;         // every block whose centroid lies inside is held
};

struct SliverSpec {      // blocks smaller than this are merged with the neighbour of the longest common edge
    double area = 0.0;   // m2; default 1e-6 of the mean block area
    double width = 0.0;  // m, 2 area / perimeter; default 1e-3 of sqrt(mean block area)
    bool given = false;  // area and width were set by the user
};

struct RockSpec {
    Polygon outline;           // or taken from `outline_file`
    std::string outline_file;  // GeoJSON polygon, relative to the scenario file
    std::string material;
    std::vector<JointSetSpec> joint_sets;
    std::vector<CrackSpec> cracks;
    std::optional<TraceMapSpec> traces;
    std::vector<Polygon> holes;  // cut and left empty
    std::vector<RegionSpec> regions;
    HeldSpec held;
    SliverSpec slivers;
    Where where;
};

struct Fixity {
    bool x = false, y = false, rotation = false;
};

struct DrivenSpec {                                         // prescribed velocity; absent parts are free
    std::optional<TimeTable> velocity_x, velocity_y, spin;  // m/s, m/s, rad/s
};

struct BlockSpec {
    std::string name;  // repeated blocks: name[0], name[1], ...
    Polygon outline;   // simple, counter-clockwise
    std::string material;
    Fixity held;
    DrivenSpec driven;
    Vec2 velocity = Vec2::Zero();  // m/s at the start
    double spin = 0.0;             // rad/s at the start
    Where where;
};

/// Names blocks: by name, by a point inside (at the start), by a region of the rock, or by an outline around the centroid.
struct Selector {
    std::string block, region;
    std::optional<Vec2> at;
    Polygon inside;
    Where where;
    std::string key;  // path in the file
};

struct LoadSpec {
    Selector block;
    VectorTable force;          // N per m of thickness
    TimeTable moment;           // N m
    std::optional<Vec2> point;  // material point of application; default: centroid
};

/// Stress in the joints before anything moves. Compression positive; sigma = [xx, yy, xy] as tractions of rock mechanics.
struct InitialStressSpec {
    // in-situ field: vertical stress surcharge + unit weight x (surface - y), horizontal = k0 x vertical
    std::optional<double> k0;
    std::optional<double> surface;      // m, y where the vertical stress equals the surcharge; default: top of the rock
    double surcharge = 0.0;             // Pa
    std::optional<double> unit_weight;  // N/m3; default: density of the rock x |gravity|
    // or a given field: stress at the origin of the scene and its increase with x and y
    std::optional<Eigen::Vector3d> stress;                                                       // Pa
    Eigen::Vector3d gradient_x = Eigen::Vector3d::Zero(), gradient_y = Eigen::Vector3d::Zero();  // Pa/m
    // or given joint by joint, which goes before the field
    struct OnJoint {
        std::string joint;
        double normal = 0.0, shear = 0.0;  // Pa
    };
    std::vector<OnJoint> joints;
    // sides of the outline whose free edges carry the matching stress as a dead load
    bool left = false, right = false, bottom = false, top = false;
};

struct DampingSpec {
    double local = 0.0;    // Cundall's alpha, 0..1
    double contact = 0.0;  // s, stiffness-proportional: force = contact x stiffness x velocity
};

struct Until {
    std::optional<double> time;         // s, length of the stage
    std::optional<double> equilibrium;  // unbalanced ratio at which the stage ends
    std::optional<int> iterations;      // of a static stage at most
    bool verdict = false;               // ends as soon as it is certain whether the blocks stand; of the run only
};

/// The error that a run may have. What the scenario leaves open is chosen for it, see simulation/plan.hpp.
struct AccuracySpec {
    std::optional<double> motion;        // share of the motion of blocks whose joints do not give
    std::optional<double> joint_stress;  // share of what joints of the stiffness given carry and close
    Where where;
    double least() const { return std::min(motion.value_or(1.0), joint_stress.value_or(1.0)); }
};

struct RunSpec {
    Until until;
    std::optional<AccuracySpec> accuracy;
    std::string solver = "auto";      // auto | explicit | rigid | static
    std::optional<double> time_step;  // s; absent: auto
    Where time_step_where;
    double step_fraction = 0.8;                            // of the rigorous bound, when automatic
    bool step_fraction_given = true, freeze_given = true;  // false: left to the accuracy
    std::optional<double> most_travel;  // m, of any point in a step of the rigid solver; no key, comes from the accuracy
    bool unchecked = false;  // accept a time step above the stable estimate, and blocks that pass through each other
    DampingSpec damping;
    double smallest_failure = 0.001;  // share of the area of free blocks; less on its way is loose stones
    std::optional<double> freeze;     // share of its weight below which a block at rest is frozen; absent: never
    int substeps = 1;                 // of blocks whose stable step is short: 1, 2, 4, 8; 0: what saves most
    std::string search = "auto";
    std::optional<double> skin;             // m; absent: automatic
    bool face_path = true;                  // closed-form path for faces; false: general distance potential everywhere
    std::optional<double> rounding_length;  // m, of corners that touch at points; absent: distance potential
    Where rounding_where;
    int threads = 1;
};

struct StageSpec {  // in order, before `run`
    std::string name;
    std::string solver = "auto";
    bool settle = false;                 // local damping 0.8 until equilibrium 1e-6, then reset
    bool reset = false;                  // afterwards clock, displacements and velocities become zero
    std::vector<Selector> remove;        // key: delete
    double release = 0.0;                // s over which the forces of deleted blocks fade away
    std::vector<JointSpec> joints;       // key: change.joints, complete after merging with the earlier values
    std::optional<VectorTable> gravity;  // in this stage only; time counted from its start
    std::vector<LoadSpec> loads;         // in this stage only, instead of those of the scene
    bool loads_given = false;
    Until until;
    DampingSpec damping;
    std::optional<double> time_step;
    Where time_step_where;
};

/// A number observed while a run goes on. What it may be: docs/scenario-reference.md, table of quantities.
struct ProbeSpec {
    std::string quantity;       // displacement, velocity, rotation, normal_stress, reaction, energy, ...
    std::string component;      // x, y, magnitude, along, ... depending on the quantity
    double direction = 0.0;     // rad, for component `along`
    std::optional<Vec2> point;  // follows the block that contains it at the start
    std::optional<Vec2> joint;  // the contact or joint face nearest to this place at the start
    std::string block;
    Where where;
    std::string key;  // path in the file of what says the place
};

struct HistorySpec {
    std::string name;
    std::vector<ProbeSpec> probes;
    std::optional<double> every;  // s; absent: every step
};

struct RecordSpec {
    std::optional<double> frame_every;  // s
    std::optional<int> frame_count;     // frames after the first one; default 50
    std::vector<HistorySpec> history;
    bool contacts = true;  // write the contacts of every frame
};

struct ExpectSpec {
    ProbeSpec probe;                   // what is observed
    std::string measure;               // value, max, min, rate, frequency, decrement, loop_area, fault, warning
    std::optional<ProbeSpec> against;  // second axis of loop_area
    std::optional<double> at;          // s; absent: end
    std::optional<std::pair<double, double>> between;  // s
    std::optional<double> value, above, below;
    std::string same_as;              // case whose verdict at the same place of its list is the value; empty: none
    std::vector<std::string> is;      // of verdict and mechanism: one of these it must be
    std::string says;                 // what a fault or warning must have in its text
    std::optional<double> tolerance;  // relative to |value|
    std::optional<double> tolerance_absolute;
    Where where;
};

struct Scenario {
    std::string title, source;
    std::string file, folder;       // as given; folder for relative paths
    Vec2 origin = Vec2::Zero();     // m, what was subtracted from every coordinate
    VectorTable gravity;            // m/s2
    VectorTable body_acceleration;  // m/s2, added to gravity; zero when absent
    std::vector<MaterialSpec> materials;
    std::vector<JointSpec> joints;
    ContactSpec contacts;
    std::optional<RockSpec> rock;
    std::vector<BlockSpec> blocks;
    std::vector<LoadSpec> loads;
    std::optional<InitialStressSpec> initial_stress;
    std::vector<StageSpec> stages;
    RunSpec run;
    RecordSpec record;
    std::vector<ExpectSpec> expect;
    std::string text;            // the file as read, with overrides noted in a last comment
    std::string canonical_json;  // resolved scenario: sorted keys (names in their order), every default, %.17g
    std::vector<std::pair<std::string, std::uint64_t>> files;  // read for the scenario, as it names them; FNV-1a of each
    std::uint64_t hash = 0;  // FNV-1a of canonical_json, followed by the hashes of the files
};

}  // namespace talus
