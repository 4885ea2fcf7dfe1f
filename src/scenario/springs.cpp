#include "scenario/springs.hpp"

#include <algorithm>
#include <array>
#include <string_view>

namespace talus {
namespace {

constexpr std::array<std::string_view, 11> of_springs{
    "normal_force", "shear_force", "normal_stress",  "max_normal_stress",  "shear_stress", "utilisation",
    "reaction",     "moment",      "contact_length", "shear_displacement", "max_overlap"};

bool depends_on_stiffness(const ProbeSpec& probe) {
    return exists_with_springs_only(probe.quantity, probe.component) || std::ranges::count(of_springs, probe.quantity) > 0;
}

// A joint closes, and blocks oscillate, by their stiffness.
bool depends_on_stiffness(const ExpectSpec& expect) {
    const bool oscillation = expect.measure == "frequency" || expect.measure == "decrement";
    const bool closure =
        expect.probe.quantity == "opening" && std::min(expect.value.value_or(0.0), expect.below.value_or(0.0)) < 0.0;
    return oscillation || closure || expect.measure == "loop_area" || depends_on_stiffness(expect.probe);
}

}  // namespace

bool exists_with_springs_only(const std::string& quantity, const std::string& component) {
    return quantity == "stable_step" || (quantity == "energy" && component.starts_with("strain"));
}

std::string asked_of_springs(const Scenario& scenario) {
    for (const HistorySpec& history : scenario.record.history)
        for (const ProbeSpec& probe : history.probes)
            if (depends_on_stiffness(probe)) return probe.quantity + " in " + history.name;
    for (const ExpectSpec& expect : scenario.expect)
        if (depends_on_stiffness(expect))
            return expect.measure == "value" || expect.measure == "max" || expect.measure == "min"
                       ? "an expected " + expect.probe.quantity
                       : "an expected " + expect.measure;
    return {};
}

}  // namespace talus
