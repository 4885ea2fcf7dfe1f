#include "scenario/springs.hpp"

#include "core/text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

namespace talus {
namespace {

// Where there are more of them than equilibrium determines, stiffness shares them out.
constexpr std::array<std::string_view, 9> forces{"normal_force",      "shear_force",  "normal_stress",
                                                 "max_normal_stress", "shear_stress", "utilisation",
                                                 "reaction",          "moment",       "contact_length"};
constexpr std::array<std::string_view, 2> movements_of_springs{"shear_displacement", "max_overlap"};
constexpr std::array<std::string_view, 8> movements{
    "displacement", "relative_displacement", "max_displacement", "position", "velocity", "rotation", "opening", "slip"};

template <std::size_t n>
bool is_one_of(const std::array<std::string_view, n>& all, const ProbeSpec& probe) {
    return std::ranges::count(all, probe.quantity) > 0;
}

bool is_give(const ProbeSpec& probe) {
    return exists_with_springs_only(probe.quantity, probe.component) || is_one_of(movements_of_springs, probe);
}

// A joint closes, and blocks oscillate, by their stiffness.
bool is_give(const ExpectSpec& expect) {
    const bool oscillation = expect.measure == "frequency" || expect.measure == "decrement";
    const bool closure =
        expect.probe.quantity == "opening" && std::min(expect.value.value_or(0.0), expect.below.value_or(0.0)) < 0.0;
    return oscillation || closure || expect.measure == "loop_area" || is_give(expect.probe);
}

/// The first of what is recorded or expected that `is`, in words.
template <class Is>
std::string first(const Scenario& scenario, Is&& is) {
    for (const HistorySpec& history : scenario.record.history)
        for (const ProbeSpec& probe : history.probes)
            if (is(probe)) return probe.quantity + " in " + history.name;
    for (const ExpectSpec& expect : scenario.expect)
        if (is(expect))
            return expect.measure == "value" || expect.measure == "max" || expect.measure == "min"
                       ? "an expected " + expect.probe.quantity
                       : "an expected " + expect.measure;
    return {};
}

struct OfForces {
    bool operator()(const ProbeSpec& probe) const { return is_one_of(forces, probe); }
    bool operator()(const ExpectSpec& expect) const { return is_one_of(forces, expect.probe); }
};
struct OfMovements {
    bool operator()(const ProbeSpec& probe) const { return is_one_of(movements, probe); }
    bool operator()(const ExpectSpec& expect) const { return is_one_of(movements, expect.probe); }
};

}  // namespace

bool exists_with_springs_only(const std::string& quantity, const std::string& component) {
    return quantity == "stable_step" || (quantity == "energy" && component.starts_with("strain"));
}

std::string asked_of_give(const Scenario& scenario) {
    return first(scenario, [](const auto& observed) { return is_give(observed); });
}

std::string asked_of_forces(const Scenario& scenario) { return first(scenario, OfForces{}); }

std::string asked_of_movements(const Scenario& scenario) { return first(scenario, OfMovements{}); }

std::string asked_below(const Scenario& scenario, double most, double size) {
    for (const ExpectSpec& e : scenario.expect) {
        const bool relative = e.probe.quantity == "relative_displacement";
        const bool way = relative || e.probe.quantity == "displacement" || e.probe.quantity == "max_displacement" ||
                         e.probe.quantity == "opening" || e.probe.quantity == "slip";
        if (!way || !e.value || e.measure == "rate") continue;
        const double value = std::abs(*e.value);
        const double allowed = std::max(e.tolerance.value_or(0.0) * value, e.tolerance_absolute.value_or(0.0));
        if (value > allowed && value <= most * (relative ? 1.0 : size))
            return "an expected " + e.probe.quantity + " of " + number(*e.value) + (relative ? "" : " m");
    }
    return {};
}

}  // namespace talus
