#include "model/rock.hpp"

#include "model/joint_lines.hpp"
#include "model/select.hpp"
#include "model/trace_lines.hpp"

namespace talus {
namespace {

// Limits of slivers when the user gives none: as shares of the mean block area and of its square root.
constexpr double sliver_area_share = 1e-6, sliver_width_share = 1e-3;

CutInput input_of(const RockSpec& rock) {
    CutInput input;
    input.outline = rock.outline;
    input.holes = rock.holes;
    input.lines = joint_lines(rock);
    for (std::size_t i = 0; i < rock.regions.size(); ++i)
        input.regions.push_back({rock.regions[i].outline, static_cast<int>(i)});
    if (rock.slivers.given) {
        input.sliver_area = rock.slivers.area;
        input.sliver_width = rock.slivers.width;
    } else {
        input.sliver_area_share = sliver_area_share;
        input.sliver_width_share = sliver_width_share;
    }
    return input;
}

// In the order of the sources of joint_lines.
std::vector<std::string> joint_of_source(const RockSpec& rock) {
    std::vector<std::string> names;
    for (const JointSetSpec& set : rock.joint_sets) names.push_back(set.joint);
    for (const CrackSpec& crack : rock.cracks) names.push_back(crack.joint);
    if (rock.traces) names.push_back(rock.traces->joint);
    return names;
}

}  // namespace

CutRock cut_rock(const RockSpec& rock, const std::vector<std::string>& material_names) {
    CutResult blocks = cut(input_of(rock));
    CutRock result;
    for (CutBlock& block : blocks.blocks) {
        const std::string& own = block.region >= 0 ? rock.regions[block.region].material : rock.material;
        const int material = index_of(material_names, own.empty() ? rock.material : own);
        result.shapes.push_back({std::move(block.parts), material, block.region, {}});
    }
    result.seams = std::move(blocks.seams);
    result.joint_of_source = joint_of_source(rock);
    result.outline = bounds(rock.outline);
    result.report = std::move(blocks.report);
    if (rock.traces) {
        const TraceLines traces = trace_lines(*rock.traces, rock.outline, tip_reach(rock), 0);
        result.trace_count = traces.traces;
        result.tips_extended = traces.tips_extended;
        result.corners_snapped = traces.corners_snapped;
        result.trace_junctions = traces.junctions;
    }
    return result;
}

}  // namespace talus
