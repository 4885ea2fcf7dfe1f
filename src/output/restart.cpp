#include "output/restart.hpp"

#include "core/errors.hpp"
#include "core/version.hpp"
#include "output/h5_file.hpp"
#include "output/results_layout.hpp"
#include "output/static_table.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

namespace talus {
namespace {

/// Breaks the build when a member is added that `transfer` does not know.
[[maybe_unused]] void every_member_is_transferred(const State& state, const Contact& contact) {
    [[maybe_unused]] const auto& [time, stage_time, calm, step, total_steps, stage, stage_step, halvings, substeps, motion,
                                  load, damping, contacts, calm_looks, fast, removed, release, start_position, start_angle,
                                  ledger, earlier_gain, statics, unsettled, unsolved, course] = state;
    [[maybe_unused]] const auto& [window_length, window_begin, next_look, looks, give, kinetic, kinetic_last, kinetic_before,
                                  sum, turn_sum, mean_time, mean, turn_mean, mean_velocity, velocity_begin, fell, speed,
                                  speed_before, going, reach, rested, no_further, set_out, mechanism, verdict, certain_at] =
        course;
    [[maybe_unused]] const auto& [unsolved_steps, unsolved_speed, unsolved_way] = unsolved;
    [[maybe_unused]] const auto& [held_back, load_share, load_rate, load_lag, pressed, window_position, window_angle,
                                  window_load, window, relaxation_damping, shift, polish_at, patience, push, start, look_at,
                                  look_share, look_ratio, look_distance, suspicious, now, earlier, newton_ratios] =
        state.statics;
    [[maybe_unused]] const auto& [position, angle, velocity, spin] = motion;
    [[maybe_unused]] const auto& [list, reaction, broken] = contacts;
    [[maybe_unused]] const auto& [total0, kinetic0, gravity, loads, work, local_damping, driven, friction, contact_damping,
                                  released, gained, largest] = ledger;
    [[maybe_unused]] const auto& [part_a, part_b, joint, face, edge_a, edge_b, touching, slipped, sliding, struck, alive,
                                  length, overlap, normal_force, shear_force, shear_energy, strength, slip, slip_sum,
                                  dilation, moment, point, normal] = contact;
}

template <class T>
struct Rows;  // how items of type T lie in a table: numbers per row, and their way there and back

template <class T>
requires std::is_arithmetic_v<T>
struct Rows<T> {
    using Number = T;
    static constexpr int width = 1;
    static void put(const T& item, std::vector<T>& flat) { flat.push_back(item); }
    static void get(T& item, const T* row) { item = *row; }
};

template <class T>
requires std::is_enum_v<T>
struct Rows<T> {
    using Number = std::underlying_type_t<T>;
    static constexpr int width = 1;
    static void put(T item, std::vector<Number>& flat) { flat.push_back(static_cast<Number>(item)); }
    static void get(T& item, const Number* row) { item = static_cast<T>(*row); }
};

template <>
struct Rows<Vec2> {
    using Number = double;
    static constexpr int width = 2;
    static void put(const Vec2& v, std::vector<double>& flat) { flat.insert(flat.end(), {v.x(), v.y()}); }
    static void get(Vec2& v, const double* row) { v = {row[0], row[1]}; }
};

template <>
struct Rows<Force> {
    using Number = double;
    static constexpr int width = 3;
    static void put(const Force& f, std::vector<double>& flat) {
        flat.insert(flat.end(), {f.force.x(), f.force.y(), f.torque});
    }
    static void get(Force& f, const double* row) { f = {{row[0], row[1]}, row[2]}; }
};

template <>
struct Rows<Reaction> {
    using Number = double;
    static constexpr int width = 4;
    static void put(const Reaction& r, std::vector<double>& flat) {
        flat.insert(flat.end(), {r.force.x(), r.force.y(), r.torque_a, r.torque_b});
    }
    static void get(Reaction& r, const double* row) { r = {{row[0], row[1]}, row[2], row[3]}; }
};

class Writing {
public:
    explicit Writing(h5::File& file) : file_(file) {}

    template <class T>
    void one(const char* name, const char* unit, const T& value) {
        list(name, unit, std::vector<T>{value});
    }
    template <class T>
    void list(const char* name, const char* unit, const std::vector<T>& items) {
        std::vector<typename Rows<T>::Number> flat;
        for (const T& item : items) Rows<T>::put(item, flat);
        write<T>(name, unit, flat, items.size());
    }
    template <class S, class T>
    void column(const char* name, const char* unit, const std::vector<S>& items, T S::*member) {
        std::vector<typename Rows<T>::Number> flat;
        for (const S& item : items) Rows<T>::put(item.*member, flat);
        write<T>(name, unit, flat, items.size());
    }

private:
    template <class T>
    void write(const char* name, const char* unit, const std::vector<typename Rows<T>::Number>& flat, std::size_t rows) {
        h5::Shape shape{static_cast<std::int64_t>(rows)};
        if (Rows<T>::width > 1) shape.push_back(Rows<T>::width);
        file_.write<typename Rows<T>::Number>(std::string("/state/") + name, flat, shape,
                                              {unit, Rows<T>::width > 1 ? "rows x numbers" : "rows"});
    }
    h5::File& file_;
};

class Reading {
public:
    explicit Reading(const h5::File& file) : file_(file) {}

    template <class T>
    void one(const char* name, const char*, T& value) {
        std::vector<T> items;
        list(name, "", items);
        if (items.size() != 1) throw InputError(file_.path() + ": damaged restart file, " + name + " is not one number");
        value = items[0];
    }
    template <class T>
    void list(const char* name, const char*, std::vector<T>& items) {
        const auto flat = read<T>(name);
        items.resize(flat.size() / Rows<T>::width);
        for (std::size_t i = 0; i < items.size(); ++i) Rows<T>::get(items[i], &flat[i * Rows<T>::width]);
    }
    template <class S, class T>
    void column(const char* name, const char*, std::vector<S>& items, T S::*member) {
        const auto flat = read<T>(name);
        if (items.empty()) items.resize(flat.size() / Rows<T>::width);
        if (flat.size() != items.size() * Rows<T>::width)
            throw InputError(file_.path() + ": damaged restart file, the lengths of the contact columns differ");
        for (std::size_t i = 0; i < items.size(); ++i) Rows<T>::get(items[i].*member, &flat[i * Rows<T>::width]);
    }

private:
    template <class T>
    std::vector<typename Rows<T>::Number> read(const char* name) const {
        return file_.read<typename Rows<T>::Number>(std::string("/state/") + name);
    }
    const h5::File& file_;
};

const std::vector<Contact>& contacts_of(const State& state) { return state.contacts.list.read(); }
std::vector<Contact>& contacts_of(State& state) { return state.contacts.list.edit(); }

template <class Archive, class List>
void transfer_contacts(Archive& to, List& list) {
    to.column("contacts/part_a", "1", list, &Contact::part_a);
    to.column("contacts/part_b", "1", list, &Contact::part_b);
    to.column("contacts/joint", "1", list, &Contact::joint);
    to.column("contacts/face", "1", list, &Contact::face);
    to.column("contacts/edge_a", "1", list, &Contact::edge_a);
    to.column("contacts/edge_b", "1", list, &Contact::edge_b);
    to.column("contacts/touching", "1", list, &Contact::touching);
    to.column("contacts/slipped", "1", list, &Contact::slipped);
    to.column("contacts/sliding", "1", list, &Contact::sliding);
    to.column("contacts/struck", "1", list, &Contact::struck);
    to.column("contacts/alive", "1", list, &Contact::alive);
    to.column("contacts/length", "m", list, &Contact::length);
    to.column("contacts/overlap", "m", list, &Contact::overlap);
    to.column("contacts/normal_force", "N", list, &Contact::normal_force);
    to.column("contacts/shear_force", "N", list, &Contact::shear_force);
    to.column("contacts/shear_energy", "J", list, &Contact::shear_energy);
    to.column("contacts/strength", "N", list, &Contact::strength);
    to.column("contacts/slip", "m", list, &Contact::slip);
    to.column("contacts/slip_sum", "m", list, &Contact::slip_sum);
    to.column("contacts/dilation", "m", list, &Contact::dilation);
    to.column("contacts/moment", "N m", list, &Contact::moment);
    to.column("contacts/point", "m", list, &Contact::point);
    to.column("contacts/normal", "1", list, &Contact::normal);
}

template <class Archive, class List>
void transfer_evidence(Archive& to, List& stages) {
    for_each_evidence([&](const char* name, auto member) {
        to.column(("statics/stages/" + std::string(name)).c_str(), "1", stages, member);
    });
}

template <class Archive, class AnyStatics>
void transfer_statics(Archive& to, AnyStatics& s) {
    to.list("statics/held_back", "N, N m", s.held_back);
    to.one("statics/load_share", "1", s.load_share);
    to.one("statics/load_rate", "1", s.load_rate);
    to.one("statics/load_lag", "1", s.load_lag);
    to.one("statics/pressed", "N", s.pressed);
    to.list("statics/position", "m", s.position);
    to.list("statics/angle", "rad", s.angle);
    to.list("statics/load", "N, N m", s.load);
    to.one("statics/window", "1", s.window);
    to.one("statics/damping", "1", s.damping);
    to.one("statics/shift", "1", s.shift);
    to.one("statics/polish_at", "1", s.polish_at);
    to.one("statics/patience", "1", s.patience);
    to.one("statics/push", "1", s.push);
    to.list("statics/start", "m", s.start);
    to.one("statics/look_at", "1", s.look_at);
    to.one("statics/look_share", "1", s.look_share);
    to.one("statics/look_ratio", "1", s.look_ratio);
    to.one("statics/look_distance", "m", s.look_distance);
    to.one("statics/suspicious", "1", s.suspicious);
    to.list("statics/newton_ratios", "1", s.newton_ratios);
    // The stage that runs now stands behind those that are over.
    std::vector<StaticEvidence> stages = s.earlier;
    stages.push_back(s.now);
    if constexpr (!std::is_const_v<AnyStatics>) stages.clear();
    transfer_evidence(to, stages);
    if constexpr (!std::is_const_v<AnyStatics>) {
        s.now = stages.back();
        stages.pop_back();
        s.earlier = std::move(stages);
    }
}

template <class Archive, class AnyCourse>
void transfer_course(Archive& to, AnyCourse& c) {
    to.one("course/window", "s", c.window);
    to.one("course/window_begin", "s", c.window_begin);
    to.one("course/next_look", "s", c.next_look);
    to.one("course/looks", "1", c.looks);
    to.one("course/give", "m", c.give);
    to.one("course/kinetic", "J", c.kinetic);
    to.one("course/kinetic_last", "J", c.kinetic_last);
    to.one("course/kinetic_before", "J", c.kinetic_before);
    to.list("course/sum", "m", c.sum);
    to.list("course/turn_sum", "rad", c.turn_sum);
    to.one("course/mean_time", "s", c.mean_time);
    to.list("course/mean", "m", c.mean);
    to.list("course/turn_mean", "rad", c.turn_mean);
    to.list("course/velocity", "m/s", c.velocity);
    to.list("course/velocity_begin", "m/s", c.velocity_begin);
    to.list("course/fell", "1", c.fell);
    to.list("course/speed", "m/s", c.speed);
    to.list("course/speed_before", "m/s", c.speed_before);
    to.list("course/going", "1", c.going);
    to.list("course/reach", "m", c.reach);
    to.list("course/rested", "1", c.rested);
    to.list("course/no_further", "1", c.no_further);
    to.list("course/set_out", "1", c.set_out);
    to.list("course/mechanism", "1", c.mechanism);
    to.one("course/verdict", "1", c.verdict);
    to.one("course/certain_at", "s", c.certain_at);
}

template <class Archive, class AnyState>
void transfer(Archive& to, AnyState& state) {
    to.one("time", "s", state.time);
    to.one("stage_time", "s", state.stage_time);
    to.one("calm_checks", "1", state.calm_checks);
    to.one("step", "1", state.step);
    to.one("total_steps", "1", state.total_steps);
    to.one("stage", "1", state.stage);
    to.one("stage_step", "s", state.stage_step);
    to.one("step_halvings", "1", state.step_halvings);
    to.one("substeps", "1", state.substeps);
    to.list("motion/position", "m", state.motion.position);
    to.list("motion/angle", "rad", state.motion.angle);
    to.list("motion/velocity", "m/s", state.motion.velocity);
    to.list("motion/spin", "rad/s", state.motion.spin);
    to.list("load", "N, N m", state.load);
    to.list("damping", "N, N m", state.damping);
    transfer_contacts(to, contacts_of(state));
    to.list("contacts/reaction", "N, N m", state.contacts.reaction);
    to.list("contacts/broken", "1", state.contacts.broken);
    to.list("calm", "1", state.calm);
    to.list("fast", "1", state.fast);
    to.list("removed", "1", state.removed);
    to.list("release", "N, N m", state.release);
    to.list("start_position", "m", state.start_position);
    to.list("start_angle", "rad", state.start_angle);
    to.one("ledger/total0", "J", state.ledger.total0);
    to.one("ledger/kinetic0", "J", state.ledger.kinetic0);
    to.one("ledger/gravity", "J", state.ledger.gravity);
    to.one("ledger/loads", "J", state.ledger.loads);
    to.one("ledger/contact", "J", state.ledger.contact);
    to.one("ledger/local_damping", "J", state.ledger.local_damping);
    to.one("ledger/driven", "J", state.ledger.driven);
    to.one("ledger/friction", "J", state.ledger.friction);
    to.one("ledger/contact_damping", "J", state.ledger.contact_damping);
    to.one("ledger/released", "J", state.ledger.released);
    to.one("ledger/gained", "J", state.ledger.gained);
    to.one("ledger/largest", "J", state.ledger.largest);
    to.one("earlier_gain", "1", state.earlier_gain);
    to.column("unsettled/stage", "1", state.unsettled, &Unsettled::stage);
    to.column("unsettled/ratio", "1", state.unsettled, &Unsettled::ratio);
    to.one("unsolved/steps", "1", state.unsolved.steps);
    to.one("unsolved/speed", "m/s", state.unsolved.speed);
    to.one("unsolved/way", "m", state.unsolved.way);
    transfer_statics(to, state.statics);
    transfer_course(to, state.course);
}

State with_contacts_alive(const State& state) {
    State kept = state;
    Contacts& contacts = kept.contacts;
    contacts.list.clear(), contacts.reaction.clear();
    for (std::size_t i = 0; i < state.contacts.list.size(); ++i) {
        if (!state.contacts.list[i].alive) continue;
        contacts.list.push_back(state.contacts.list[i]);
        contacts.reaction.push_back(state.contacts.reaction[i]);
    }
    return kept;
}

// Lists of different lengths, one behind the other.
void write_memory(h5::File& file, const std::vector<std::vector<double>>& memory) {
    std::vector<std::int64_t> lengths;
    std::vector<double> values;
    for (const std::vector<double>& one : memory) {
        lengths.push_back(static_cast<std::int64_t>(one.size()));
        values.insert(values.end(), one.begin(), one.end());
    }
    file.write<std::int64_t>("/restart/memory_lengths", lengths, {static_cast<std::int64_t>(lengths.size())},
                             {"1", "probes with a memory"});
    file.write<double>("/restart/memory", values, {static_cast<std::int64_t>(values.size())}, {"", "their numbers"});
}

std::vector<std::vector<double>> read_memory(const h5::File& file) {
    const auto values = file.read<double>("/restart/memory");
    std::vector<std::vector<double>> memory;
    std::size_t at = 0;
    for (const std::int64_t length : file.read<std::int64_t>("/restart/memory_lengths")) {
        const std::size_t end = std::min(values.size(), at + static_cast<std::size_t>(length));
        memory.emplace_back(values.begin() + static_cast<std::ptrdiff_t>(at),
                            values.begin() + static_cast<std::ptrdiff_t>(end));
        at = end;
    }
    return memory;
}

void write_info(h5::File& file, const RestartInfo& info) {
    file.make_group("/restart");
    file.set("/restart", "schema_version", std::int64_t{restart_schema});
    file.set("/restart", "scenario_file", info.scenario_file);
    file.set("/restart", "scenario_hash", hash_text(info.scenario_hash));
    file.set("/restart", "frames", info.frames);
    file.write_text("/restart/scenario", info.scenario_text);
    file.write_texts("/restart/overrides", info.overrides, "overrides");
    std::vector<std::string> names;
    std::vector<std::int64_t> rows;
    for (const auto& [name, count] : info.history_rows) names.push_back(name), rows.push_back(count);
    file.write_texts("/restart/history_names", names, "histories");
    file.write<std::int64_t>("/restart/history_rows", rows, {static_cast<std::int64_t>(rows.size())}, {"1", "histories"});
    file.set("/restart", "stages_recorded", std::int64_t{info.stages_recorded});
    write_memory(file, info.memory);
}

h5::File open_restart(const std::string& path) {
    h5::File file = h5::File::open(path);
    if (!file.has_attribute("/restart", "schema_version")) throw InputError(path + ": is not a restart file of Talus");
    const std::int64_t found = file.integer("/restart", "schema_version");
    if (found != restart_schema)
        throw InputError(path + ": written in version " + std::to_string(found) +
                         " of the restart format, this program reads version " + std::to_string(restart_schema));
    return file;
}

bool within(int value, int first, std::size_t end) { return value >= first && value < static_cast<int>(end); }

bool fits(const Course& c, std::size_t blocks) {
    const auto all = [&](const auto&... lists) { return ((lists.size() == blocks) && ...); };
    return c.window == 0.0 || all(c.sum, c.turn_sum, c.mean, c.turn_mean, c.velocity, c.velocity_begin, c.fell, c.speed,
                                  c.speed_before, c.going, c.reach, c.rested, c.no_further, c.set_out, c.mechanism);
}

bool fits(const State& s, const Model& model) {
    const std::size_t blocks = model.blocks.mass.size(), contacts = s.contacts.list.size();
    const auto one_per_block = [&](const auto&... lists) { return ((lists.size() == blocks) && ...); };
    const auto known = [&](const Contact& c) {
        return within(c.part_a, 0, model.parts.block.size()) && within(c.part_b, 0, model.parts.block.size()) &&
               within(c.joint, 0, model.joints.size()) && within(c.face, -1, model.faces.size()) &&
               within(c.edge_a, -1, model.corners.arm.size()) && within(c.edge_b, -1, model.corners.arm.size());
    };
    return one_per_block(s.motion.position, s.motion.angle, s.motion.velocity, s.motion.spin, s.load, s.removed,
                         s.start_position, s.start_angle) &&
           (s.release.empty() || s.release.size() == blocks) && (s.damping.empty() || s.damping.size() == blocks) &&
           (s.calm.empty() || s.calm.size() == blocks) && (s.fast.empty() || s.fast.size() == blocks) &&
           fits(s.course, blocks) && s.contacts.reaction.size() == contacts &&
           s.contacts.broken.size() == static_cast<std::size_t>(model.cells()) &&
           std::all_of(s.contacts.list.begin(), s.contacts.list.end(), known);
}

}  // namespace

void write_restart(const std::string& path, const RestartInfo& info, const State& state) {
    const std::string unfinished = path + ".part";
    try {
        {
            h5::File file = h5::File::create(unfinished);
            write_info(file, info);
            Writing archive(file);
            const State kept = with_contacts_alive(state);
            transfer(archive, kept);
            file.flush();
        }
        std::filesystem::rename(unfinished, path);
    } catch (const std::exception& error) {
        std::remove(unfinished.c_str());
        throw OutputError(error.what());
    }
}

RestartInfo read_restart_info(const std::string& path) {
    const h5::File file = open_restart(path);
    RestartInfo info;
    info.scenario_file = file.text("/restart", "scenario_file");
    info.scenario_text = file.read_text("/restart/scenario");
    info.scenario_hash = std::strtoull(file.text("/restart", "scenario_hash").c_str(), nullptr, 16);
    info.overrides = file.read_texts("/restart/overrides");
    info.frames = file.integer("/restart", "frames");
    const auto names = file.read_texts("/restart/history_names");
    const auto rows = file.read<std::int64_t>("/restart/history_rows");
    for (std::size_t i = 0; i < names.size() && i < rows.size(); ++i) info.history_rows.emplace_back(names[i], rows[i]);
    info.stages_recorded = static_cast<int>(file.integer("/restart", "stages_recorded"));
    info.memory = read_memory(file);
    return info;
}

State read_restart(const std::string& path, const Model& model) {
    const h5::File file = open_restart(path);
    State state;
    Reading archive(file);
    transfer(archive, state);
    if (!fits(state, model)) throw InputError(path + ": does not fit the scenario: other blocks, joints or faces");
    return state;
}

}  // namespace talus
