#include "contact/search.hpp"

#include "contact/search_methods.hpp"
#include "core/errors.hpp"
#include "core/spelling.hpp"

#include <array>

namespace talus {
namespace {

struct Method {
    const char* name;
    std::unique_ptr<PairSearch> (*make)();
};

constexpr std::array methods = {
    Method{"auto", make_auto_search},
    Method{"safe-regions", make_safe_regions_search},
    Method{"verlet", make_verlet_search},
    Method{"isu", make_isu_search},
    Method{"isu-separated", make_isu_separated_search},
    Method{"isu-parallel", make_isu_parallel_search},
    Method{"dess", make_dess_search},
    Method{"dess-fused", make_dess_fused_search},
    Method{"direct", make_direct_search},
    Method{"direct-simd", make_direct_simd_search},
    Method{"grid", make_grid_search},
};

constexpr auto names = [] {
    std::array<const char*, methods.size()> all{};
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = methods[i].name;
    return all;
}();

InputError unknown(const std::string& name) {
    const std::vector<std::string_view> allowed(names.begin(), names.end());
    std::string message = "unknown search \"" + name + "\"; allowed:";
    for (const char* each : names) message += std::string(" ") + each;
    const std::string_view nearest = nearest_spelling(name, allowed);
    if (!nearest.empty()) message += "; did you mean " + std::string(nearest) + "?";
    return InputError(message);
}

}  // namespace

std::span<const char* const> search_names() { return names; }

std::unique_ptr<PairSearch> make_search(const std::string& name) {
    for (const Method& method : methods)
        if (name == method.name) return method.make();
    throw unknown(name);
}

}  // namespace talus
