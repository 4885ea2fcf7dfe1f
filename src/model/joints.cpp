#include "model/joints.hpp"

#include "model/build.hpp"
#include "model/select.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace talus {
namespace {

// A pair of large regions would fill the memory with block pairs; a material of their own says the same in one entry.
constexpr std::size_t most_block_pairs = 1'000'000;

Pair ordered(int i, int j) { return i < j ? Pair{i, j} : Pair{j, i}; }

std::optional<int> find_joint(const std::vector<std::pair<Pair, int>>& table, Pair key) {
    const auto at = std::lower_bound(table.begin(), table.end(), key, [](const auto& row, Pair k) { return row.first < k; });
    if (at == table.end() || at->first != key) return std::nullopt;
    return at->second;
}

// Sorts by pair; of several rows for one pair the last one given holds.
void sort_table(std::vector<std::pair<Pair, int>>& table) {
    std::stable_sort(table.begin(), table.end(), [](const auto& x, const auto& y) { return x.first < y.first; });
    std::vector<std::pair<Pair, int>> unique;
    for (const auto& row : table) {
        if (!unique.empty() && unique.back().first == row.first)
            unique.back() = row;
        else
            unique.push_back(row);
    }
    table = std::move(unique);
}

// Length, m, over which a seam covers the stretch [0, length] along a unit vector; <= 0 if it does not.
double covered(const CutSeam& seam, const Vec2& from, const Vec2& along, double length, double tolerance) {
    const Vec2 first = seam.from - from, last = seam.to - from;
    if (std::abs(cross(along, first)) > tolerance || std::abs(cross(along, last)) > tolerance) return 0.0;
    const auto [lo, hi] = std::minmax({along.dot(first), along.dot(last)});
    return std::min(hi, length) - std::max(lo, 0.0);
}

}  // namespace

int joint_index(const Model& model, const std::string& name) {
    const auto at = std::find_if(model.joints.begin(), model.joints.end(), [&](const Joint& j) { return j.name == name; });
    return at == model.joints.end() ? -1 : static_cast<int>(at - model.joints.begin());
}

Joint make_joint(const JointSpec& spec) {
    const ResidualSpec residual = spec.residual.value_or(ResidualSpec{spec.friction_angle, spec.cohesion});
    Joint joint;
    joint.kn = spec.normal_stiffness;
    joint.ks = spec.shear_stiffness;
    joint.tan_friction = std::tan(spec.friction_angle);
    joint.cohesion = spec.cohesion;
    joint.tension = spec.tension;
    joint.tan_friction_residual = std::tan(residual.friction_angle);
    joint.cohesion_residual = residual.cohesion;
    joint.tan_dilation = std::tan(spec.dilation_angle);
    if (spec.dilation_cutoff_slip) joint.dilation_cutoff_slip = *spec.dilation_cutoff_slip;
    joint.restitution = spec.restitution.value_or(0.0);
    joint.weakens = spec.residual.has_value();
    joint.cells = spec.cells;
    joint.name = spec.name;
    return joint;
}

int Model::joint_between(PartId a, PartId b) const {
    const BlockId block_a = parts.block[a], block_b = parts.block[b];
    if (const auto joint = find_joint(joint_of_blocks, ordered(block_a, block_b))) return *joint;
    if (const auto joint = find_joint(joint_of_faces, ordered(a, b))) return *joint;
    if (joint_of_materials.empty()) return default_joint;
    return joint_of_materials[blocks.material[block_a] * material_names.size() + blocks.material[block_b]];
}

void fill_joint_tables(const Scenario& scenario, Model& model, std::vector<Fault>& faults) {
    const auto fault = [&](const std::string& key, const std::string& message) {
        faults.push_back(Fault{Where{scenario.file, 0}, key, message});
    };
    const auto joint = [&](const std::string& name, const std::string& key) {
        const int found = joint_index(model, name);
        if (found < 0) fault(key, "there is no joint named `" + name + "`");
        return std::max(found, 0);
    };
    for (const JointSpec& spec : scenario.joints) model.joints.push_back(make_joint(spec));
    const ContactSpec& contacts = scenario.contacts;
    if (!contacts.default_joint.empty()) model.default_joint = joint(contacts.default_joint, "contacts.default");

    const std::size_t nm = model.material_names.size();
    model.joint_of_materials.assign(nm * nm, model.default_joint);
    for (const auto& row : contacts.materials) {
        const int a = index_of(model.material_names, row.a), b = index_of(model.material_names, row.b);
        const int j = joint(row.joint, "contacts.materials");
        if (a < 0) fault("contacts.materials", "there is no material named `" + row.a + "`");
        if (b < 0) fault("contacts.materials", "there is no material named `" + row.b + "`");
        if (a >= 0 && b >= 0) model.joint_of_materials[a * nm + b] = model.joint_of_materials[b * nm + a] = j;
    }

    for (const auto& row : contacts.blocks) {
        const std::vector<BlockId> as = blocks_named(model, row.a), bs = blocks_named(model, row.b);
        const int j = joint(row.joint, "contacts.blocks");
        if (as.empty()) fault("contacts.blocks", "no block or region is named `" + row.a + "`");
        if (bs.empty()) fault("contacts.blocks", "no block or region is named `" + row.b + "`");
        if (as.size() * bs.size() > most_block_pairs) {
            fault("contacts.blocks", "`" + row.a + "` and `" + row.b +
                                         "` are too many pairs of blocks; give one of them a " +
                                         "material of its own and use contacts.materials");
            continue;
        }
        for (const BlockId a : as)
            for (const BlockId b : bs)
                if (a != b) model.joint_of_blocks.push_back({ordered(a, b), j});
    }
    sort_table(model.joint_of_blocks);
}

void fill_joint_of_faces(std::span<const Neighbours::Touch> touches, std::span<const Vec2> corner,
                         std::vector<CutSeam> seams, std::span<const int> joint_of_source, double tolerance, Model& model) {
    std::erase_if(seams, [&](const CutSeam& seam) { return seam.source < 0 || joint_of_source[seam.source] < 0; });
    const auto between = [](const CutSeam& seam) { return ordered(seam.left, seam.right); };
    std::ranges::stable_sort(seams, {}, between);
    for (const Neighbours::Touch& touch : touches) {
        const Pair blocks = ordered(model.parts.block[touch.part_a], model.parts.block[touch.part_b]);
        const Vec2 along = perp(model.corners.normal[touch.edge_a]), from = corner[touch.edge_a] + touch.s0 * along;
        const CutSeam* best = nullptr;
        double longest = 0.0;
        for (auto seam = std::ranges::lower_bound(seams, blocks, {}, between);
             seam != seams.end() && between(*seam) == blocks; ++seam) {
            const double length = covered(*seam, from, along, touch.s1 - touch.s0, tolerance);
            if (length > longest) best = &*seam, longest = length;
        }
        if (best != nullptr)
            model.joint_of_faces.push_back({Pair{touch.part_a, touch.part_b}, joint_of_source[best->source]});
    }
}

}  // namespace talus
