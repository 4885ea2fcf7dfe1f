// What is observed: histories and expectations.
#include "scenario/convert.hpp"
#include "scenario/nearest.hpp"
#include "scenario/quantities.hpp"

#include <algorithm>
#include <set>

namespace talus {
namespace {

using Place = Quantity::Place;

bool has(const Quantity& quantity, const std::string& component) {
    return std::find(quantity.components.begin(), quantity.components.end(), component) != quantity.components.end();
}

void check_place(const Quantity& quantity, const Cursor& at) {
    const bool body = at["point"].given() || at["block"].given(), joint = at["joint"].given();
    const bool wrong = quantity.place == Place::scene   ? body || joint
                       : quantity.place == Place::joint ? !joint
                       : quantity.place == Place::any   ? joint
                                                        : !body;
    if (wrong) at.fault(quantity.name + " needs: " + place_text(quantity.place));
}

/// Component that is observed; `fallback` when none is named, a fault if there has to be one.
std::string convert_component(const Quantity& quantity, const Cursor& at, const std::string& fallback) {
    const Cursor component = at["component"], direction = at["direction_deg"];
    std::string chosen = component.given() ? component.text() : direction.given() ? "along" : fallback;
    if (component.given() && !has(quantity, component.text())) {
        const std::string which = quantity.components.empty() ? "none" : enumerate(quantity.components, " | ");
        component.fault(quantity.name + " has no component " + component.text() + "; it has: " + which);
    } else if (chosen.empty() && !quantity.components.empty()) {
        component.fault("is missing: " + enumerate(quantity.components, " | "));
    }
    if (direction.given() && chosen != "along") direction.fault("goes with component: along");
    if (direction.given() && !component.given() && !has(quantity, "along"))
        direction.fault(quantity.name + " has no direction");
    if (!direction.given() && chosen == "along") direction.fault("is missing: component along needs a direction");
    return chosen;
}

ProbeSpec probe_at(const Cursor& at, const std::string& quantity, const std::string& component) {
    ProbeSpec probe;
    probe.quantity = quantity;
    probe.component = component;
    probe.direction = at["direction_deg"].angle();
    probe.point = at["point"].maybe_point();
    probe.joint = at["joint"].maybe_point();
    if (at["block"].given()) probe.block = convert_block_name(at["block"]);
    const Cursor place = at["point"].given()   ? at["point"]
                         : at["joint"].given() ? at["joint"]
                         : at["block"].given() ? at["block"]
                                               : at;
    probe.where = place.where();
    probe.key = place.path();
    return probe;
}

std::vector<std::string> quantities_of(const Cursor& at) {
    if (at["quantity"].given()) return {at["quantity"].text()};
    std::vector<std::string> names;
    for (const Cursor& name : at["quantities"].items()) names.push_back(name.text());
    if (!names.empty()) return names;
    if (at["joint"].given()) return {"normal_stress", "shear_stress", "opening", "slip"};
    if (at["point"].given()) return {"displacement", "velocity"};
    if (at["block"].given()) return {"displacement", "velocity", "rotation"};
    return {"energy", "unbalanced"};
}

HistorySpec convert_history(const Cursor& at) {
    HistorySpec history;
    history.name = at["name"].text();
    history.every = at["every"].maybe_number();
    for (const std::string& name : quantities_of(at)) {
        const Quantity* quantity = find_quantity(name);
        if (!quantity) continue;
        check_place(*quantity, at);
        const bool plane = has(*quantity, "x") && !at["component"].given() && !at["direction_deg"].given();
        if (plane) {
            history.probes.push_back(probe_at(at, name, "x"));
            history.probes.push_back(probe_at(at, name, "y"));
        } else {
            // `component` belongs to the quantities that have one; rotation beside displacement needs none.
            const bool takes = !quantity->components.empty() || at["quantity"].given();
            const std::string component = takes ? convert_component(*quantity, at, quantity->component) : "";
            history.probes.push_back(probe_at(at, name, component));
        }
    }
    return history;
}

bool of_the_verdict(const Quantity& quantity) { return quantity.name == "verdict" || quantity.name == "mechanism"; }

/// Said of a run beside its numbers.
bool told(const Quantity& quantity) {
    return of_the_verdict(quantity) || quantity.name == "fault" || quantity.name == "warning";
}

std::string measure_of(const Quantity& quantity, const Cursor& at) {
    if (quantity.name == "acceleration") return "rate";
    if (quantity.name == "frequency" || quantity.name == "decrement" || quantity.name == "loop_area") return quantity.name;
    if (quantity.name == "stable" || quantity.name == "unstable") return "max";
    if (told(quantity)) return quantity.name;
    if (at["at"].text() == "max" || at["at"].text() == "min") return at["at"].text();
    return "value";
}

/// What a history has to record for this quantity.
const Quantity& observed(const Quantity& quantity, const Cursor& at) {
    if (quantity.name == "acceleration") return *find_quantity("velocity");
    if (quantity.name == "loop_area") return *find_quantity(at["of"].given() ? at["of"].text() : "shear_stress");
    if (quantity.name == "frequency" || quantity.name == "decrement")
        return *find_quantity(at["of"].given() ? at["of"].text() : "displacement");
    if (quantity.name == "stable" || quantity.name == "unstable") {
        const bool somewhere = at["point"].given() || at["block"].given();
        return *find_quantity(!at["limit"].given() ? "relative_displacement"
                              : somewhere          ? "displacement"
                                                   : "max_displacement");
    }
    return quantity;
}

void check_times(const ExpectSpec& expect, const Quantity& quantity, const Cursor& at) {
    const Cursor between = at["between"];
    if (expect.measure == "rate" && !between.given()) between.fault("is missing: acceleration is taken between two times");
    if (expect.between && !(expect.between->first < expect.between->second)) between.fault("times must increase");
    if (expect.measure == "value" && between.given())
        between.fault("goes with at: max or min, or with " + std::string("acceleration, frequency, decrement, loop_area"));
    if (expect.measure != "value" && expect.measure != "max" && expect.measure != "min" && at["at"].given())
        at["at"].fault("does not go with " + quantity.name);
}

void check_bounds(const ExpectSpec& expect, const Quantity& quantity, const Cursor& at) {
    const bool no_number = told(quantity), in_words = no_number && !of_the_verdict(quantity);
    const bool stands = quantity.name == "stable" || quantity.name == "unstable";
    const bool likened = at["same_as"].given();
    const bool bounded = at["value"].given() || likened || at["above"].given() || at["below"].given();
    if ((no_number || stands) && bounded) at.fault(quantity.name + " takes no value, same_as, above or below");
    if (!no_number && !stands && !bounded) at.fault("needs exactly one of value, same_as, above, below");
    if (!stands && at["limit"].given()) at["limit"].fault("goes with stable and unstable");
    if (in_words != at["says"].given())
        at["says"].fault(in_words ? "is missing: words of the text" : "goes with fault and warning");
    if (of_the_verdict(quantity) != at["is"].given())
        at["is"].fault(of_the_verdict(quantity) ? "is missing: what is expected" : "goes with verdict and mechanism");
    const bool tolerance = expect.tolerance || expect.tolerance_absolute;
    if (tolerance && !expect.value && !likened) at.fault("a tolerance goes with value and same_as");
    if (likened && !tolerance) at["same_as"].fault("needs tolerance or tolerance_absolute");
    if (!expect.value) return;
    if (!expect.tolerance && !expect.tolerance_absolute) at["value"].fault("needs tolerance or tolerance_absolute");
    if (*expect.value == 0.0 && expect.tolerance && !expect.tolerance_absolute)
        at["tolerance"].fault("is relative to |value|, which is 0; give tolerance_absolute");
}

const std::vector<std::string>& words_of(const Quantity& quantity) {
    static const std::vector<std::string> verdicts{"stable", "unstable", "undecided"};
    static const std::vector<std::string> mechanisms{"none", "slide", "topple", "slide and topple", "fall", "rotation"};
    return quantity.name == "verdict" ? verdicts : mechanisms;
}

void set_words(ExpectSpec& expect, const Quantity& quantity, const Cursor& is) {
    if (!of_the_verdict(quantity) || !is.given()) return;
    const std::vector<Cursor> items = is.items();
    for (const Cursor& word : items.empty() ? std::vector<Cursor>{is} : items) {
        expect.is.push_back(word.text());
        const std::vector<std::string>& words = words_of(quantity);
        if (std::find(words.begin(), words.end(), word.text()) == words.end())
            word.fault("is none of: " + enumerate(words, " | "));
    }
}

void set_bounds(ExpectSpec& expect, const Quantity& quantity, const Cursor& at) {
    expect.value = at["value"].maybe_number();
    expect.same_as = at["same_as"].text();
    expect.says = at["says"].text();
    set_words(expect, quantity, at["is"]);
    expect.above = at["above"].maybe_number();
    expect.below = at["below"].maybe_number();
    expect.tolerance = at["tolerance"].maybe_number();
    expect.tolerance_absolute = at["tolerance_absolute"].maybe_number();
    check_bounds(expect, quantity, at);
    const double limit = at["limit"].maybe_number().value_or(1e-3);
    if (quantity.name == "stable") expect.below = limit;
    if (quantity.name == "unstable") expect.above = limit;
}

ExpectSpec convert_expectation(const Cursor& at) {
    ExpectSpec expect;
    expect.where = at.where();
    const Quantity* quantity = find_quantity(at["quantity"].text());
    if (!quantity) return expect;  // refused before
    const Quantity& seen = observed(*quantity, at);
    const bool oscillates = quantity->name == "frequency" || quantity->name == "decrement";
    const bool loop = quantity->name == "loop_area";
    check_place(oscillates ? seen : *quantity, at);
    if (oscillates && at["component"].text() == "magnitude")
        at["component"].fault("a magnitude does not oscillate about its mean");
    expect.probe = probe_at(at, seen.name, convert_component(seen, at, oscillates ? "" : seen.component));
    expect.measure = measure_of(*quantity, at);
    expect.at = at["at"].maybe_number();
    if (const std::vector<double> times = at["between"].numbers(); times.size() == 2) expect.between = {times[0], times[1]};
    if (loop) expect.against = probe_at(at, at["against"].given() ? at["against"].text() : "shear_displacement", "");
    if (at["against"].given() && !loop) at["against"].fault("goes with loop_area");
    if (at["of"].given() && !loop && !oscillates) at["of"].fault("goes with frequency, decrement and loop_area");
    check_times(expect, *quantity, at);
    set_bounds(expect, *quantity, at);
    return expect;
}

}  // namespace

RecordSpec convert_record(const Cursor& at) {
    RecordSpec record;
    record.frame_every = at["frames"]["every"].maybe_number();
    if (at["frames"]["count"].given()) record.frame_count = static_cast<int>(at["frames"]["count"].number());
    std::set<std::string> names;
    for (const Cursor& history : at["history"].items()) {
        record.history.push_back(convert_history(history));
        const std::string& name = record.history.back().name;
        if (name.empty() || name == "." || name.find('/') != std::string::npos)
            history["name"].fault("is the name of a group of the results, and must not be empty, a dot or contain a slash");
        if (!names.insert(name).second) history["name"].fault("a history of this name is there already");
    }
    record.contacts = at["contacts"].yes();
    return record;
}

std::vector<ExpectSpec> convert_expect(const Cursor& expect) {
    std::vector<ExpectSpec> all;
    for (const Cursor& at : expect.items()) all.push_back(convert_expectation(at));
    return all;
}

}  // namespace talus
