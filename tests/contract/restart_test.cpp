// A restart holds State in every bit; a run that stopped and went on leaves the same results as one that did not.
#include "output/restart.hpp"

#include "core/errors.hpp"
#include "support/catch.hpp"
#include "support/folder.hpp"
#include "support/small_run.hpp"

#include <cstring>
#include <filesystem>
#include <fstream>

using namespace talus;

namespace {

/// All numbers of a state in the order of their declaration, as bits.
class Bits {
public:
    explicit Bits(const State& s) {
        add(s.time, s.stage_time, s.calm_checks, s.step, s.total_steps, s.stage, s.stage_step, s.step_halvings);
        for (const auto* list : {&s.motion.position, &s.motion.velocity, &s.start_position}) each(*list);
        for (const auto* list : {&s.motion.angle, &s.motion.spin, &s.start_angle}) each(*list);
        for (const auto* list : {&s.load, &s.damping, &s.release}) each(*list);
        each(s.removed);
        each(s.contacts.broken);
        each(s.contacts.list.read());
        each(s.contacts.reaction);
        const Ledger& l = s.ledger;
        add(l.total0, l.kinetic0, l.gravity, l.loads, l.contact, l.local_damping, l.driven, l.friction, l.contact_damping,
            l.released, l.gained, l.largest, s.earlier_gain);
        const Statics& t = s.statics;
        for (const auto* list : {&t.held_back, &t.load}) each(*list);
        for (const auto* list : {&t.position, &t.start}) each(*list);
        for (const auto* list : {&t.angle, &t.newton_ratios}) each(*list);
        add(t.load_share, t.load_rate, t.window, t.damping, t.shift, t.polish_at, t.patience, t.look_at, t.look_share,
            t.look_ratio, t.look_distance, t.suspicious, t.now, t.load_lag, t.pressed, t.push);
        each(t.earlier);
        each(s.unsettled);
        const Course& c = s.course;
        add(c.window, c.window_begin, c.next_look, c.looks, c.give, c.kinetic, c.kinetic_last, c.kinetic_before, c.mean_time,
            c.verdict, c.certain_at);
        for (const auto* list : {&c.sum, &c.mean, &c.velocity, &c.velocity_begin}) each(*list);
        for (const auto* list : {&c.turn_sum, &c.turn_mean, &c.speed, &c.speed_before, &c.reach}) each(*list);
        for (const auto* list : {&c.going, &c.rested, &c.no_further, &c.fell}) each(*list);
        each(c.set_out);
        each(c.mechanism);
    }
    bool operator==(const Bits&) const = default;

private:
    template <class... T>
    void add(const T&... values) {
        (one(values), ...);
    }
    template <class T>
    void each(const std::vector<T>& list) {
        add(list.size());
        for (const T& item : list) one(item);
    }
    template <class T>
    void one(const T& value) {
        const auto* bytes = reinterpret_cast<const char*>(&value);
        bytes_.append(bytes, sizeof value);
    }
    void one(const Vec2& v) { add(v.x(), v.y()); }
    void one(const Force& f) { add(f.force, f.torque); }
    void one(const Reaction& r) { add(r.force, r.torque_a, r.torque_b); }
    void one(const StaticEvidence& e) {
        add(e.stage, e.reached, e.moving, e.ratio, e.drift, e.loading_ratio, e.iterations, e.evaluations, e.increments,
            e.newton_steps);
    }
    void one(const Unsettled& u) { add(u.stage, u.ratio); }
    void one(const Contact& c) {
        add(c.part_a, c.part_b, c.joint, c.face, c.edge_a, c.edge_b, c.touching, c.slipped, c.sliding, c.struck, c.alive,
            c.length);
        add(c.overlap, c.normal_force, c.shear_force, c.strength, c.slip, c.slip_sum, c.dilation, c.moment, c.point,
            c.normal);
    }
    std::string bytes_;
};

/// The wall with bonded faces, so that there are cells.
Model bonded_wall() {
    Model model = test::wall(4, 3);
    model.joints[0].cells = 3;
    for (int p = 0; p + 1 < model.parts.size(); ++p) {
        JointFace face{};
        face.part_a = p, face.part_b = p + 1, face.bonded = true, face.first_cell = 3 * p;
        model.faces.push_back(face);
    }
    return model;
}

RestartInfo info_now(const ResultsWriter& writer) {
    return {"wall.yaml",
            "title: A wall\n",
            test::run_info().scenario_hash,
            {"run.threads=2"},
            writer.frames(),
            writer.history_rows(),
            0,
            {}};
}

}  // namespace

TEST_CASE("a restart gives back every member of the state in every bit, without contacts that are not alive") {
    const Model model = bonded_wall();
    const test::Folder folder;
    const std::string path = folder / "run.restart.h5";
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        State state = test::random_state(model, seed, static_cast<int>(seed) * 9);
        if (seed % 2) state.release.clear();
        state.motion.angle[0] = -0.0, state.motion.spin[1] = 5e-324;
        write_restart(path, {}, state);
        const State again = read_restart(path, model);
        State alive = state;
        alive.contacts.list.clear(), alive.contacts.reaction.clear();
        for (std::size_t i = 0; i < state.contacts.list.size(); ++i)
            if (state.contacts.list[i].alive) {
                alive.contacts.list.push_back(state.contacts.list[i]);
                alive.contacts.reaction.push_back(state.contacts.reaction[i]);
            }
        CHECK(again.contacts.list.size() < state.contacts.list.size());
        CHECK(Bits(again) == Bits(alive));
        CHECK_FALSE(Bits(again) == Bits(state));
    }
}

TEST_CASE("a restart without any contact or history reads back") {
    const Model model = test::wall(2, 1);
    const test::Folder folder;
    const std::string path = folder / "run.restart.h5";
    write_restart(path, {}, test::at_rest(model));
    CHECK(read_restart(path, model).contacts.list.empty());
    CHECK(read_restart_info(path).history_rows.empty());
}

TEST_CASE("a restart knows its scenario and how far the results were") {
    const test::Folder folder;
    const std::string path = folder / "run.restart.h5";
    const RestartInfo info{"a.yaml",
                           "title: x\n",
                           0xfedcba9876543210ULL,
                           {"a=1", "b=[2, 3]"},
                           17,
                           {{"toe", 400}, {"crest", 0}},
                           2,
                           {{1.5, -2.0}, {}, {0.25}}};
    write_restart(path, info, test::at_rest(test::wall(2, 1)));
    const RestartInfo again = read_restart_info(path);
    CHECK(again.scenario_file == info.scenario_file);
    CHECK(again.scenario_text == info.scenario_text);
    CHECK(again.scenario_hash == info.scenario_hash);
    CHECK(again.overrides == info.overrides);
    CHECK(again.frames == 17);
    CHECK(again.history_rows == info.history_rows);
    CHECK(again.stages_recorded == 2);
    CHECK(again.memory == info.memory);
}

TEST_CASE("a restart file that is not one is refused in one line") {
    const Model model = bonded_wall();
    const test::Folder folder;
    const std::string path = folder / "run.restart.h5";
    const auto refused = [&](const std::string& why) {
        CHECK_THROWS_AS(read_restart(path, model), InputError);
        CHECK_THROWS_WITH(read_restart(path, model), Catch::Contains(why) && !Catch::Contains("\n"));
    };
    refused("No such file or directory");
    std::ofstream(path) << "title: not a restart\n";
    refused("cannot be read");
    ResultsWriter(path, model, test::run_info());
    refused("is not a restart file of Talus");

    write_restart(path, {}, test::random_state(model, 1, 50));
    const auto size = std::filesystem::file_size(path);
    std::filesystem::resize_file(path, size / 2);
    refused("truncated");

    write_restart(path, {}, test::at_rest(test::wall(5, 5)));
    refused("does not fit");
    write_restart(path, {}, test::at_rest(model));
    {
        h5::File file = h5::File::edit(path);
        file.set("/restart", "schema_version", std::int64_t{999});
        file.flush();
    }
    refused("version 999");
}

TEST_CASE("a restart that cannot be written leaves the one before") {
    const Model model = test::wall(2, 1);
    const test::Folder folder;
    const std::string path = folder / "run.restart.h5";
    RestartInfo info;
    info.frames = 3;
    write_restart(path, info, test::at_rest(model));
    info.frames = 4;
    std::filesystem::create_directory(path + ".part");
    CHECK_THROWS_AS(write_restart(path, info, test::at_rest(model)), OutputError);
    CHECK(read_restart_info(path).frames == 3);
}

TEST_CASE("results of a run that was stopped and resumed are those of one that was not") {
    const Model model = test::wall(3, 2);
    const test::Folder folder;
    const std::string whole = folder / "whole.h5", resumed = folder / "resumed.h5";
    constexpr int stop = 5, lost = 9, end = 12;
    {
        ResultsWriter writer(whole, model, test::run_info());
        const int toe = test::add_toe(writer);
        for (int k = 0; k < end; ++k) test::write_frame(writer, model, toe, k);
    }
    RestartInfo info;
    {
        ResultsWriter writer(resumed, model, test::run_info());
        const int toe = test::add_toe(writer);
        for (int k = 0; k < stop; ++k) test::write_frame(writer, model, toe, k);
        info = info_now(writer);
        for (int k = stop; k < lost; ++k) test::write_frame(writer, model, toe, k + 100);  // not those of the whole run
    }
    {
        ResultsWriter writer = ResultsWriter::reopen(resumed, info.scenario_hash, info.frames, info.history_rows);
        CHECK(writer.frames() == stop);
        const int toe = test::add_toe(writer);
        for (int k = stop; k < end; ++k) test::write_frame(writer, model, toe, k);
    }
    CHECK(test::damage(resumed, model, end) == "");
    const h5::File a = h5::File::open(whole), b = h5::File::open(resumed);
    REQUIRE(a.datasets() == b.datasets());
    for (const std::string& path : a.datasets()) {
        INFO(path);
        REQUIRE(a.shape(path) == b.shape(path));
        if (a.text(path, "unit") == "-")
            CHECK(a.read_texts(path) == b.read_texts(path));
        else
            CHECK(a.read<double>(path) == b.read<double>(path));
    }
}

TEST_CASE("only the results of the same run are gone on with") {
    const Model model = test::wall(3, 2);
    const test::Folder folder;
    const std::string path = folder / "run.h5";
    RestartInfo info;
    {
        ResultsWriter writer(path, model, test::run_info());
        const int toe = test::add_toe(writer);
        test::write_frame(writer, model, toe, 0);
        info = info_now(writer);
    }
    CHECK_THROWS_WITH(ResultsWriter::reopen(path, 77, 1, {}), Catch::Contains("another scenario"));
    CHECK_THROWS_WITH(ResultsWriter::reopen(path, info.scenario_hash, 2, {}), Catch::Contains("has 1 frames"));
    CHECK_THROWS_WITH(ResultsWriter::reopen(path, info.scenario_hash, 1, {{"toe", 11}}), Catch::Contains("shorter"));
    CHECK_THROWS_AS(ResultsWriter::reopen(folder / "none.h5", info.scenario_hash, 1, {}), InputError);
    CHECK(test::damage(path, model, 1) == "");
}
