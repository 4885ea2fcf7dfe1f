#include "simulation/expect.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace talus {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

double lowest(const Signal& s) { return s.value.empty() ? std::nan("") : *std::min_element(s.value.begin(), s.value.end()); }

double highest(const Signal& s) {
    return s.value.empty() ? std::nan("") : *std::max_element(s.value.begin(), s.value.end());
}

double measure(const ExpectSpec& e, const Signal& whole, const Signal& whole_against) {
    const double first = e.between ? e.between->first : -infinity, last = e.between ? e.between->second : infinity;
    if (e.measure == "value") return e.at ? value_at(whole, *e.at) : whole.value.empty() ? std::nan("") : whole.value.back();
    if (e.measure == "rate") return mean_rate(whole, first, last);
    if (e.between && std::isnan(value_at(whole, last))) return std::nan("");  // a maximum of half the window proves nothing
    const Signal part = between(whole, first, last);
    if (e.measure == "max") return highest(part);
    if (e.measure == "min") return lowest(part);
    if (e.measure == "frequency") return frequency(part);
    if (e.measure == "decrement") return decrement(part);
    return loop_area(between(whole_against, first, last), part);
}

std::string description(const ExpectSpec& e, const std::string& name) {
    std::ostringstream text;
    text << name;
    if (e.measure != "value") text << ", " << e.measure;
    if (e.at) text << " at " << *e.at << " s";
    if (e.between) text << ' ' << e.between->first << ".." << e.between->second << " s";
    return text.str();
}

std::string joined(const std::vector<std::string>& words) {
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : " or ") + word;
    return text;
}

Verdict judge_verdict(const ExpectSpec& e, const std::optional<StabilityVerdict>& told, BlockId block) {
    const std::string found = !told                    ? "not told"
                              : e.measure == "verdict" ? name_of(told->verdict)
                              : block < 0              ? name_of(told->mechanism)
                                                       : name_of(told->block_mechanism[static_cast<std::size_t>(block)]);
    const bool passed = std::find(e.is.begin(), e.is.end(), found) != e.is.end();
    const std::string of = block < 0 ? "" : " of block " + std::to_string(block);
    const double measured = passed ? 1.0 : 0.0;
    return {e.measure + of + " is " + found + (passed ? "" : ", not " + joined(e.is)),
            measured,
            1.0,
            1.0 - measured,
            0.0,
            passed};
}

}  // namespace

bool about_the_verdict(const ExpectSpec& e) { return e.measure == "verdict" || e.measure == "mechanism"; }

Verdict judge(const ExpectSpec& e, const std::string& name, const Signal& observed, const Signal& against) {
    Verdict v{description(e, name), measure(e, observed, against), 0.0, 0.0, 0.0, false};
    if (e.value) {
        v.expected = *e.value;
        v.error = std::abs(v.measured - v.expected);
        v.allowed = std::max(e.tolerance.value_or(0.0) * std::abs(v.expected), e.tolerance_absolute.value_or(0.0));
    } else {
        const double short_of = e.above.value_or(-infinity) - v.measured, beyond = v.measured - e.below.value_or(infinity);
        const bool lower = !e.below || short_of > beyond;  // also where nothing was measured, and neither holds
        v.expected = lower ? e.above.value_or(0.0) : *e.below;
        v.asked = lower ? "above" : "below";
        v.error = std::isnan(v.measured) ? v.measured : std::max({0.0, short_of, beyond});
    }
    v.passed = v.error <= v.allowed;  // false for NaN
    return v;
}

bool about_what_is_told(const ExpectSpec& e) {
    return e.measure == "fault" || e.measure == "warning" || about_the_verdict(e);
}

Verdict judge(const ExpectSpec& e, const Told& told, BlockId block) {
    if (about_the_verdict(e)) return judge_verdict(e, told.verdict, block);
    const auto has = [&](const std::string& text) { return text.find(e.says) != std::string::npos; };
    const bool there = e.measure == "fault" ? !told.fault.empty() && has(told.fault)
                                            : std::any_of(told.warnings.begin(), told.warnings.end(), has);
    const double measured = there ? 1.0 : 0.0;
    return {e.measure + " `" + e.says + "`", measured, 1.0, 1.0 - measured, 0.0, there};
}

Watch::Watch(const std::vector<ExpectSpec>& expects, const Model& model, const State& state) {
    for (const ExpectSpec& e : expects) {
        if (about_what_is_told(e)) {
            const bool of_a_block = e.probe.point || !e.probe.block.empty();
            watched_.push_back({e, {}, of_a_block ? observed_block(e.probe, model, state) : -1, {}});
            continue;
        }
        Watched w{e, {make_probe(e.probe, model, state)}, -1, {}};
        if (e.against) w.probes.push_back(make_probe(*e.against, model, state));
        w.signals.resize(w.probes.size());
        watched_.push_back(std::move(w));
    }
}

bool Watch::needs_energies() const {
    return std::any_of(watched_.begin(), watched_.end(), [](const Watched& w) {
        return std::any_of(w.probes.begin(), w.probes.end(), [](const Probe& p) { return p.needs_energies; });
    });
}

void Watch::record(const Model& model, const State& state, const Gauges& gauges) {
    const bool reset = state.time < last_time_;
    last_time_ = state.time;
    for (Watched& w : watched_) {
        for (std::size_t i = 0; i < w.probes.size(); ++i) {
            if (reset) w.signals[i] = {};
            w.signals[i].time.push_back(state.time);
            w.signals[i].value.push_back(w.probes[i].read(model, state, gauges));
        }
    }
}

std::vector<Verdict> Watch::judge(const Told& told) const {
    std::vector<Verdict> verdicts;
    for (const Watched& w : watched_)
        verdicts.push_back(w.probes.empty() ? talus::judge(w.expect, told, w.block)
                                            : talus::judge(w.expect, w.probes[0].name, w.signals[0],
                                                           w.signals.size() > 1 ? w.signals[1] : Signal{}));
    return verdicts;
}

}  // namespace talus
