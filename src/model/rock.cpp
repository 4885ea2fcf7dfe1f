#include "model/rock.hpp"

#include "model/select.hpp"

#include <algorithm>

namespace talus {
namespace {

// Limits of slivers when the user gives none: as shares of the mean block area and of its square root.
constexpr double sliver_area_share = 1e-6, sliver_width_share = 1e-3;

}  // namespace

CutRock cut_rock(const RockSpec& rock, const std::string& folder, const std::vector<std::string>& material_names) {
    CutRock result;
    CutInput input;
    input.outline = rock.outline;
    input.holes = rock.holes;
    for (std::size_t i = 0; i < rock.regions.size(); ++i) input.regions.push_back({rock.regions[i].outline, static_cast<int>(i)});
    (void)folder;
    if (rock.slivers.given) {
        input.sliver_area = rock.slivers.area;
        input.sliver_width = rock.slivers.width;
    } else {
        input.sliver_area_share = sliver_area_share;
        input.sliver_width_share = sliver_width_share;
    }
    CutResult cut_result = cut(input);

    for (CutBlock& block : cut_result.blocks) {
        const std::string& own = block.region >= 0 ? rock.regions[block.region].material : rock.material;
        const int material = index_of(material_names, own.empty() ? rock.material : own);
        result.shapes.push_back({std::move(block.parts), material, block.region, {}});
    }
    result.seams = std::move(cut_result.seams);
    result.outline = bounds(input.outline);
    result.report = std::move(cut_result.report);
    return result;
}

}  // namespace talus
