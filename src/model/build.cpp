#include "model/build.hpp"

#include "core/text.hpp"
#include "model/box_axes.hpp"
#include "model/initial_stress.hpp"
#include "model/joints.hpp"
#include "model/neighbours.hpp"
#include "model/rock.hpp"
#include "model/rounding.hpp"
#include "model/select.hpp"
#include "model/shapes.hpp"
#include "model/supports.hpp"
#include "model/warnings.hpp"

#include <algorithm>
#include <cmath>

namespace talus {
namespace {

// Edges closer than this share of the size of the scene coincide; deeper overlaps are faults.
constexpr double relative_tolerance = 1e-9;
constexpr std::size_t most_overlaps_told = 50;  // more of them have one cause and hide the other faults

/// m/s2, under which the run begins. A static stage has its tables at their end.
Vec2 gravity_at_start(const Scenario& scenario) {
    const bool only = scenario.stages.empty(), own = !only && scenario.stages.front().gravity;
    const VectorTable& gravity = own ? *scenario.stages.front().gravity : scenario.gravity;
    const std::string& solver = only ? scenario.run.solver : scenario.stages.front().solver;
    if (solver != "static" || (!only && !own)) return gravity(0.0);
    return {gravity.x.at_the_end()(0.0), gravity.y.at_the_end()(0.0)};
}

class Builder {
public:
    explicit Builder(const Scenario& scenario) : scenario_(scenario), model_(scene_.model) {}
    Scene build();

private:
    void name_materials();
    void cut_rock_into_shapes();
    void shape_single_blocks();
    void hold();
    void find_touching_parts();
    void tell_overlaps(std::span<const Neighbours::Overlap> overlaps);
    void set_joints();
    double rock_weight(const InitialStressSpec& spec);
    void set_initial_stress();
    void set_state();
    void set_loads();
    void round_corners();

    int material(const std::string& name, const Where& where, const std::string& key);
    std::string title(BlockId block) const;
    const Where& where(BlockId block) const;
    void fault(const Where& where, const std::string& key, const std::string& message) {
        faults_.push_back({where, key, message});
    }
    void throw_faults() const {
        if (!faults_.empty()) throw InputError(faults_);
    }

    const Scenario& scenario_;
    Scene scene_;
    Model& model_;
    std::vector<Fault> faults_;
    CutRock rock_;                 // no shapes if the scene has no rock
    std::vector<Shape> shapes_;    // those of the rock first
    std::vector<double> density_;  // [nm] kg/m3
    std::vector<Vec2> corner_;     // [nc] m, as given
    Box all_{};                    // m, around everything
    double tolerance_ = 0.0;       // m
    Neighbours neighbours_;
    std::vector<int> joint_;  // of every touch
    Prestress prestress_;
};

int Builder::material(const std::string& name, const Where& at, const std::string& key) {
    const int found = index_of(model_.material_names, name);
    if (found < 0) fault(at, key, "there is no material named `" + name + "`");
    return std::max(found, 0);
}

std::string Builder::title(BlockId b) const {
    if (!model_.blocks.name[b].empty()) return "block `" + model_.blocks.name[b] + "`";
    return "the block of rock at " + place(model_.blocks.start[b] + model_.origin);
}

const Where& Builder::where(BlockId b) const {
    const int rock_blocks = static_cast<int>(rock_.shapes.size());
    return b < rock_blocks ? scenario_.rock->where : scenario_.blocks[b - rock_blocks].where;
}

void Builder::name_materials() {
    for (const MaterialSpec& spec : scenario_.materials) {
        model_.material_names.push_back(spec.name);
        density_.push_back(spec.density);
        if (!(spec.density > 0.0)) fault({scenario_.file, 0}, "materials." + spec.name + ".density", "must be positive");
    }
}

void Builder::cut_rock_into_shapes() {
    const RockSpec& rock = *scenario_.rock;
    material(rock.material, rock.where, "rock.material");
    for (const RegionSpec& region : rock.regions) {
        model_.region_names.push_back(region.name);
        if (!region.material.empty()) material(region.material, rock.where, "rock.regions." + region.name + ".material");
    }
    throw_faults();
    rock_ = cut_rock(rock, model_.material_names);
    shapes_ = rock_.shapes;
    scene_.report.cut = rock_.report;
    scene_.report.trace_count = rock_.trace_count;
    scene_.report.tips_extended = rock_.tips_extended;
    scene_.report.corners_snapped = rock_.corners_snapped;
    scene_.report.trace_junctions = rock_.trace_junctions;
}

void Builder::shape_single_blocks() {
    for (const BlockSpec& spec : scenario_.blocks) {
        const std::string key = "blocks." + spec.name;
        const Polygon outline = without_straight_corners(spec.outline);
        Shape shape{{}, material(spec.material, spec.where, key + ".material"), -1, spec.name};
        if (outline.size() < 3) {
            fault(spec.where, key, "the outline encloses no area");
        } else if (const auto edges = crossing_edges(outline)) {
            fault(spec.where, key,
                  "edges " + std::to_string(edges->first + 1) + " and " + std::to_string(edges->second + 1) +
                      " of the outline meet each other");
        } else if (signed_area(outline) <= 0.0) {
            fault(spec.where, key, "the corners must go around counter-clockwise");
        } else {
            shape.parts = convex_parts(outline);
        }
        if (spec.held.x && spec.driven.velocity_x) fault(spec.where, key, "cannot be held and driven along x");
        if (spec.held.y && spec.driven.velocity_y) fault(spec.where, key, "cannot be held and driven along y");
        if (spec.held.rotation && spec.driven.spin) fault(spec.where, key, "cannot be held and driven in rotation");
        shapes_.push_back(std::move(shape));
    }
}

void Builder::hold() {
    const int rock_blocks = static_cast<int>(rock_.shapes.size());
    if (scenario_.rock) hold_rock(*scenario_.rock, corner_, rock_blocks, rock_.outline, model_, faults_);
    for (std::size_t i = 0; i < scenario_.blocks.size(); ++i)
        hold_block(scenario_.blocks[i], rock_blocks + static_cast<int>(i), model_);
}

void Builder::find_touching_parts() {
    all_ = bounds(corner_);
    // Far from the origin the corners themselves are not given any better than to a few units in the last place.
    tolerance_ = relative_tolerance * std::max(all_.xmax - all_.xmin, all_.ymax - all_.ymin) + 2.0 * rounding(corner_);
    neighbours_ = find_neighbours(model_, corner_, tolerance_);
    tell_overlaps(neighbours_.overlaps);
}

void Builder::tell_overlaps(std::span<const Neighbours::Overlap> overlaps) {
    for (const auto& overlap : overlaps.first(std::min(overlaps.size(), most_overlaps_told))) {
        fault(where(overlap.b), "blocks",
              title(overlap.b) + " overlaps " + title(overlap.a) + " by " + number(overlap.depth) + " m at " +
                  place(overlap.at + model_.origin));
    }
    if (overlaps.size() > most_overlaps_told)
        fault({scenario_.file, 0}, "blocks",
              std::to_string(overlaps.size() - most_overlaps_told) + " more pairs of blocks overlap");
}

void Builder::set_joints() {
    if (model_.joints.empty() && model_.blocks.size() > 1)
        fault({scenario_.file, 0}, "joints", "at least one joint is needed, for what acts between the blocks");
    std::vector<int> joint_of_source;
    for (const std::string& name : rock_.joint_of_source) {
        joint_of_source.push_back(joint_index(model_, name));
        if (!name.empty() && joint_of_source.back() < 0)
            fault(scenario_.rock->where, "rock", "there is no joint named `" + name + "`");
    }
    throw_faults();
    fill_joint_of_faces(neighbours_.touches, corner_, rock_.seams, joint_of_source, tolerance_, model_);
    scene_.report.faces_per_joint.assign(model_.joints.size(), 0);
    for (const auto& touch : neighbours_.touches) {
        joint_.push_back(model_.joint_between(touch.part_a, touch.part_b));
        ++scene_.report.faces_per_joint[joint_.back()];
    }
}

/// N/m3, that of the field by default; the density is that of the rock around all regions.
double Builder::rock_weight(const InitialStressSpec& spec) {
    const Vec2 gravity = gravity_at_start(scenario_);
    if (gravity.isZero() && spec.k0 && !spec.unit_weight && (spec.surcharge == 0.0 || !scenario_.gravity.x.is_constant()))
        scene_.report.warnings.push_back(
            "initial_stress.k0: there is no gravity when the run begins, so that the stress does not grow with depth; give "
            "initial_stress.unit_weight");
    const int rock =
        scenario_.rock ? index_of(model_.material_names, scenario_.rock->material) : model_.blocks.material.front();
    return density_[rock] * gravity.norm();
}

void Builder::set_initial_stress() {
    const InitialStressSpec* spec = scenario_.initial_stress ? &*scenario_.initial_stress : nullptr;
    StressField field;
    if (spec != nullptr) {
        for (const auto& row : spec->joints)
            if (joint_index(model_, row.joint) < 0)
                fault({scenario_.file, 0}, "initial_stress.joints", "there is no joint named `" + row.joint + "`");
        const Box& outline = scenario_.rock ? rock_.outline : all_;
        const int blocks = scenario_.rock ? static_cast<int>(rock_.shapes.size()) : model_.blocks.size();
        const bool loaded[] = {spec->left, spec->right, spec->bottom, spec->top};
        for (int i = 0; i < 4; ++i)
            if (loaded[i] && edges_on_side(model_, corner_, blocks, outline, sides[i]).empty())
                fault({scenario_.file, 0}, std::string("initial_stress.") + side_names[i],
                      "loads nothing: no block has an edge along this side of the box around the rock");
        throw_faults();
        field = stress_field(*spec, rock_weight(*spec), outline.ymax);
        model_.loads = boundary_loads(model_, *spec, field, corner_, neighbours_.covered, blocks, outline);
        model_.boundary_loads = static_cast<int>(model_.loads.size());
    }
    prestress_ = make_faces(model_, neighbours_.touches, joint_, corner_, spec, field);
    model_.faces = std::move(prestress_.faces);
}

void Builder::set_state() {
    State& state = scene_.state;
    const int nb = model_.blocks.size(), rock_blocks = static_cast<int>(rock_.shapes.size());
    state = state_at_start(model_);
    for (BlockId b = rock_blocks; b < nb; ++b) {
        const BlockSpec& spec = scenario_.blocks[b - rock_blocks];
        state.motion.velocity[b] = (model_.blocks.inv_mass[b].array() > 0.0).select(spec.velocity, 0.0);
        state.motion.spin[b] = model_.blocks.inv_inertia[b] > 0.0 ? spec.spin : 0.0;
    }
    for (const DrivenBlock& driven : model_.driven) {
        if (driven.x) state.motion.velocity[driven.block].x() = driven.velocity_x(0.0);
        if (driven.y) state.motion.velocity[driven.block].y() = driven.velocity_y(0.0);
        if (driven.rotation) state.motion.spin[driven.block] = driven.spin(0.0);
    }
    state.contacts.list = first_contacts(model_, prestress_.shear_force);
    state.contacts.reaction.assign(state.contacts.list.size(), {});
}

void Builder::set_loads() {
    model_.gravity_x = scenario_.gravity.x + scenario_.body_acceleration.x;
    model_.gravity_y = scenario_.gravity.y + scenario_.body_acceleration.y;
    model_.local_damping = scenario_.run.damping.local;
    model_.contact_damping = scenario_.run.damping.contact;
    model_.face_path = scenario_.run.face_path;
    for (Load& load : make_loads(model_, scene_.state, scenario_.loads)) model_.loads.push_back(std::move(load));
}

void Builder::round_corners() {
    if (!scenario_.run.rounding_length) return;
    const auto concave = [&](BlockId b) { return model_.blocks.first_part[b + 1] > model_.blocks.first_part[b] + 1; };
    int count = 0;
    BlockId first = -1;
    for (BlockId b = model_.blocks.size(); b-- > 0;)
        if (concave(b)) ++count, first = b;
    if (count > 0)
        fault(where(first), "run.rounding_length",
              "rounds convex blocks only, and " + std::to_string(count) + " are concave, the first of them " + title(first) +
                  "; leave it out, or cut them into convex ones");
    if (!model_.faces.empty())
        fault({scenario_.file, 0}, "initial_stress",
              "is not available with run.rounding_length; let the joints take up their load in a stage that settles");
    throw_faults();
    model_.rounding_length = *scenario_.run.rounding_length;
    model_.corners.cut = corner_cuts(model_, model_.rounding_length);
}

Scene Builder::build() {
    model_.origin = scenario_.origin;
    name_materials();
    if (scenario_.rock) cut_rock_into_shapes();
    shape_single_blocks();
    if (shapes_.empty()) fault({scenario_.file, 0}, {}, "there is nothing to simulate: give `rock` or `blocks`");
    throw_faults();

    corner_ = fill_blocks(shapes_, density_, model_);
    model_.box_axis = box_axis(model_.corners);
    hold();
    fill_joint_tables(scenario_, model_, faults_);
    find_touching_parts();
    set_joints();
    set_initial_stress();
    round_corners();
    set_state();
    set_loads();
    for (std::string& warning : warnings(scenario_, scene_.model, neighbours_, prestress_, scene_.report.faces_per_joint))
        scene_.report.warnings.push_back(std::move(warning));
    return std::move(scene_);
}

}  // namespace

std::vector<Load> make_loads(const Model& model, const State& state, const std::vector<LoadSpec>& specs) {
    std::vector<Load> loads;
    for (const LoadSpec& spec : specs)
        for (const BlockId b : select(model, state, spec.block)) {
            const Vec2 arm = spec.point ? Vec2(*spec.point - model.blocks.start[b]) : Vec2(Vec2::Zero());
            loads.push_back({b, arm, spec.force.x, spec.force.y, spec.moment});
        }
    return loads;
}

State state_at_start(const Model& model) {
    const int nb = model.blocks.size();
    State state;
    state.motion = {model.blocks.start, std::vector<double>(nb, 0.0), std::vector<Vec2>(nb, Vec2::Zero()),
                    std::vector<double>(nb, 0.0)};
    state.load.assign(nb, {});
    state.removed.assign(nb, 0);
    state.start_position = state.motion.position;
    state.start_angle = state.motion.angle;
    state.contacts.broken.assign(model.cells(), 0);
    return state;
}

Scene build(const Scenario& scenario) { return Builder(scenario).build(); }

}  // namespace talus
