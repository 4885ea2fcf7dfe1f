#include "core/errors.hpp"
#include "output/contact_table.hpp"
#include "output/output_path.hpp"
#include "support/catch.hpp"
#include "support/folder.hpp"
#include "support/small_run.hpp"

#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

using namespace talus;
using test::Folder;

namespace {

std::string content(const std::string& path) {
    std::stringstream text;
    text << std::ifstream(path).rdbuf();
    return text.str();
}

/// A model with one contact between its two parts, pressed by 100 N over 2 m.
struct OneContact {
    Model model = test::wall(2, 1);
    State state = test::at_rest(model);
    OneContact() {
        Contact c{};
        c.part_a = 0, c.part_b = 1, c.alive = c.touching = 1;
        c.length = 2.0, c.normal_force = 100.0, c.shear_force = -30.0, c.overlap = 1e-6, c.strength = 50.0;
        c.point = {1.0, 0.25}, c.normal = {1.0, 0.0};
        state.contacts.list = {c};
    }
    Contact& contact() { return state.contacts.list[0]; }
    Joint& joint() { return model.joints[0]; }
    void bond(int cells) {
        JointFace face{};
        face.part_b = 1, face.bonded = true;
        joint().cells = cells;
        model.faces = {face};
        contact().face = 0;
        state.contacts.broken.assign(static_cast<std::size_t>(cells), 0);
    }
    ContactState now() { return contact_state(model, state.contacts, contact()); }
};

}  // namespace

TEST_CASE("an existing result is not overwritten unless that is forced") {
    const Folder folder;
    const std::string path = folder / "slope.h5";
    CHECK(choose_output_path(path, false) == path);
    CHECK_FALSE(std::filesystem::exists(path));
    std::ofstream(path) << "precious";
    CHECK(choose_output_path(path, false) == folder / "slope-2.h5");
    std::ofstream(folder / "slope-2.h5") << "precious too";
    CHECK(choose_output_path(path, false) == folder / "slope-3.h5");
    CHECK(choose_output_path(path, true) == path);
    CHECK(content(path) == "precious");
}

TEST_CASE("a path that cannot be written is refused before anything runs") {
    const Folder folder;
    CHECK_THROWS_AS(choose_output_path(folder / "no/such/folder/run.h5", false), InputError);
    std::ofstream(folder / "file") << "x";
    CHECK_THROWS_WITH(choose_output_path(folder / "file/run.h5", true), Catch::Contains("Not a directory"));
    std::filesystem::create_directory(folder / "sub");
    CHECK_THROWS_WITH(choose_output_path(folder / "sub", false), Catch::Contains("Is a directory"));
    CHECK_THROWS_WITH(ResultsWriter(folder / "no/run.h5", test::wall(2, 1), {}), Catch::Contains("No such file"));
}

TEST_CASE("a restart file lies beside its results and goes when they are replaced") {
    const Folder folder;
    const std::string path = folder / "slope.v2.h5", restart = folder / "slope.v2.restart.h5";
    CHECK(restart_path(path) == restart);
    std::ofstream(restart) << "of an earlier run";
    ResultsWriter(path, test::wall(2, 1), test::run_info());
    CHECK_FALSE(std::filesystem::exists(restart));
}

TEST_CASE("provenance reads back") {
    const Folder folder;
    Model model = test::wall(2, 1);
    model.origin = {450000.25, 6500000.5};
    RunInfo info = test::run_info();
    info.scenario_text = std::string(100000, 'x') + "\nlast line: \xc3\xa9\n";  // longer than an attribute may be
    {
        ResultsWriter writer(folder / "run.h5", model, info);
        CHECK(ResultsReader(folder / "run.h5").status() == "in progress");
        writer.finish({"interrupted", 12.5, 11.5, 3000000000, 1.5, 0.0, {}});
    }
    const ResultsReader reader(folder / "run.h5");
    CHECK(reader.scenario_text() == info.scenario_text);
    CHECK(reader.canonical_json() == info.canonical_json);
    CHECK(reader.overrides() == info.overrides);
    CHECK(reader.files() == info.files);
    CHECK(reader.status() == "interrupted");
    CHECK(reader.blocks() == 2);
    const auto list = reader.attributes();
    const std::map<std::string, std::string> attributes(list.begin(), list.end());
    CHECK(attributes.at("origin") == "450000.25 6500000.5");
    CHECK(attributes.at("scenario_hash") == "0123456789abcdef");
    CHECK(attributes.at("cpu_time") == "11.5");
    CHECK(attributes.at("steps") == "3000000000");
    CHECK(attributes.at("time_step") == "1e-05");
    CHECK(attributes.at("source") == "");
}

TEST_CASE("frames hold position and angle exactly and everything else as it was") {
    const Folder folder;
    const Model model = test::wall(3, 2);
    ResultsWriter writer(folder / "run.h5", model, test::run_info());
    const int toe = test::add_toe(writer);
    for (int k = 0; k < 3; ++k) test::write_frame(writer, model, toe, k);
    CHECK(test::damage(folder / "run.h5", model, 3) == "");  // while the writer still has it open
}

TEST_CASE("points of the picture are the corners of the parts, moved and turned with their block") {
    const Folder folder;
    const Model model = test::l_and_square();
    State state = test::at_rest(model);
    state.motion.position[0] += Vec2(10.0, 0.0);
    state.motion.angle[0] = radians(90.0);
    {
        ResultsWriter writer(folder / "run.h5", model, test::run_info());
        writer.frame(model, test::at_rest(model), {});
        writer.frame(model, state, {});
    }
    const h5::File file = h5::File::open(folder / "run.h5");
    const auto points = file.read<float>("/VTKHDF/Points");
    REQUIRE(points.size() == 2 * 12 * 3);
    // Centroid of the L: areas 3 and 2 with centroids (1.5, 0.5) and (0.5, 2). Its first corner was the origin.
    const Vec2 c((3 * 1.5 + 2 * 0.5) / 5, (3 * 0.5 + 2 * 2.0) / 5);
    CHECK(points[0] == Approx(0.0).margin(1e-6));
    CHECK(points[36] == Approx(10.0 + c.x() + c.y()));
    CHECK(points[37] == Approx(c.y() - c.x()));
    CHECK(points[38] == 0.0f);
    CHECK(file.read<std::int64_t>("/VTKHDF/Polygons/Offsets") == std::vector<std::int64_t>{0, 4, 8, 12});
    CHECK(file.read<std::int32_t>("/VTKHDF/CellData/block_id") == std::vector<std::int32_t>{0, 0, 1});
    CHECK(file.read<std::int64_t>("/VTKHDF/Steps/PointOffsets") == std::vector<std::int64_t>{0, 12});
    CHECK(file.read<std::int64_t>("/VTKHDF/Steps/CellDataOffsets/velocity") == std::vector<std::int64_t>{0, 3});
    CHECK(file.shape("/VTKHDF/Steps/CellOffsets") == h5::Shape{2, 4});
    const auto displacement = file.read<float>("/VTKHDF/CellData/displacement");
    CHECK(displacement[3 * 3] == 10.0f);  // second frame: part 0 and 1 belong to the L
    CHECK(displacement[3 * 4] == 10.0f);
    CHECK(displacement[3 * 5] == 0.0f);
}

TEST_CASE("the unbalanced force leaves out what a support carries and what local damping hides") {
    const Folder folder;
    Model model = test::wall(2, 1);                                // both held
    model.blocks.inv_mass[1] = {1.0 / model.blocks.mass[1], 0.0};  // this one is on a roller
    State state = test::at_rest(model);
    state.load[0] = {{3.0, 4.0}, 0.0}, state.load[1] = {{-3.0, 4.0}, 0.0};
    state.damping = {{}, {{2.0, 0.0}, 0.0}};
    ResultsWriter writer(folder / "run.h5", model, test::run_info());
    writer.frame(model, state, {});
    const h5::File file = h5::File::open(folder / "run.h5");
    CHECK(file.read<float>("/VTKHDF/CellData/unbalanced_force") == std::vector<float>{0.0f, 5.0f});
    CHECK(file.read<std::uint8_t>("/talus/blocks/held") == std::vector<std::uint8_t>{1, 0});
}

TEST_CASE("contacts are written as stresses, opening and utilisation; forgotten ones are not") {
    const Folder folder;
    OneContact one;
    Contact forgotten = one.contact();
    forgotten.alive = 0;
    one.state.contacts.list.push_back(forgotten);
    ResultsWriter writer(folder / "run.h5", one.model, test::run_info());
    writer.frame(one.model, one.state, {});
    const h5::File file = h5::File::open(folder / "run.h5");
    const auto only = [&](const std::string& name) {
        const auto column = file.read<double>("/talus/contacts/" + name);
        REQUIRE(column.size() == 1);
        return column[0];
    };
    CHECK(only("row_count") == 1);
    CHECK(only("block_b") == 1);
    CHECK(only("normal_stress") == 50.0);
    CHECK(only("shear_stress") == -15.0);
    CHECK(only("opening") == Approx(-1e-6));
    CHECK(only("utilisation") == Approx(30.0 / 50.0));
    CHECK(only("y") == 0.25);
}

TEST_CASE("a scene that records no contacts has no contact table") {
    const Folder folder;
    const OneContact one;
    RunInfo info = test::run_info();
    info.contacts = false;
    ResultsWriter writer(folder / "run.h5", one.model, info);
    writer.frame(one.model, one.state, {});
    CHECK_FALSE(h5::File::open(folder / "run.h5").exists("/talus/contacts"));
    CHECK(ResultsReader(folder / "run.h5").frames() == 1);
}

TEST_CASE("the state of a contact tells what the joint does now") {
    OneContact one;
    CHECK(one.now() == ContactState::elastic);
    one.contact().slipped = 1;
    CHECK(one.now() == ContactState::slipped);
    one.contact().sliding = 1;
    CHECK(one.now() == ContactState::sliding);
    one.contact().touching = 0, one.contact().sliding = 0;
    CHECK(one.now() == ContactState::open);
    one.bond(2);
    CHECK(one.now() == ContactState::bonded);
    one.state.contacts.broken = {1, 2};
    CHECK(one.now() == ContactState::open);
    one.contact().touching = 1;
    CHECK(one.now() == ContactState::broken);
}

TEST_CASE("histories keep their columns in order, and more rows than fit in memory") {
    const Folder folder;
    const Model model = test::wall(2, 1);
    {
        ResultsWriter writer(folder / "run.h5", model, test::run_info());
        const int z = writer.add_history("z", {{"b", "m"}, {"a", "Pa"}});
        const int empty = writer.add_history("empty", {{"b", "m"}});
        for (int i = 0; i < 10000; ++i) writer.append_history(z, 0.1 * i, std::vector<double>{1.0 * i, -1.0 * i});
        CHECK(writer.history_rows() == HistoryRows{{"z", 10000}, {"empty", 0}});
        CHECK(empty == 1);
        writer.flush();
    }
    const ResultsReader reader(folder / "run.h5");
    CHECK(reader.history_names() == std::vector<std::string>{"empty", "z"});
    const Table z = reader.history("z");
    REQUIRE(z.rows() == 10000);
    CHECK(z.columns[1].name == "b");
    CHECK(z.columns[2].unit == "Pa");
    CHECK(z.values[2][9999] == -9999.0);
    CHECK(reader.history("empty").rows() == 0);
    CHECK_THROWS_WITH(reader.history("toe"), Catch::Contains("no history toe"));
}

TEST_CASE("names that a file cannot hold are refused") {
    const Folder folder;
    ResultsWriter writer(folder / "run.h5", test::wall(2, 1), test::run_info());
    CHECK_THROWS_AS(writer.add_history("a/b", {{"x", "m"}}), InputError);
    CHECK_THROWS_AS(writer.add_history("a", {{"x", "m"}, {"x", "m"}}), InputError);
    CHECK_THROWS_AS(writer.add_history("a", {{"time", "s"}}), InputError);
    CHECK_THROWS_AS(writer.add_history("", {{"x", "m"}}), InputError);
}

TEST_CASE("export writes energies and histories with names and units, to the last digit") {
    const Folder folder;
    const Model model = test::wall(2, 1);
    {
        ResultsWriter writer(folder / "run.h5", model, test::run_info());
        const int toe = writer.add_history("toe", {{"x", "m"}});
        writer.append_history(toe, 0.1, std::vector<double>{1.0 / 3.0});
        Energies energies;
        energies.kinetic = 2.5, energies.gravity = 1.0;
        State state = test::at_rest(model);
        state.time = 0.1;
        writer.frame(model, state, energies);
    }
    const auto written = export_csv(folder / "run.h5", folder / "tables/csv");
    CHECK(written == std::vector<std::string>{folder / "tables/csv/energies.csv", folder / "tables/csv/toe.csv"});
    CHECK(content(written[1]) == "time [s],x [m]\n0.1,0.3333333333333333\n");
    CHECK(content(written[0]).rfind("time [s],kinetic [J],strain_normal [J],", 0) == 0);
    CHECK(content(written[0]).find("\n0.1,2.5,0,0,0,0,0,0,1,0,0,1.5\n") != std::string::npos);
    std::ofstream(folder / "file") << "x";
    CHECK_THROWS_AS(export_csv(folder / "run.h5", folder / "file"), OutputError);
}

TEST_CASE("a file that is not a result of this version is refused in one line") {
    const Folder folder;
    const std::string path = folder / "run.h5";
    const auto refused = [&](const std::string& why) {
        CHECK_THROWS_AS(ResultsReader(path), InputError);
        CHECK_THROWS_WITH(ResultsReader(path), Catch::Contains(path) && Catch::Contains(why) && !Catch::Contains("\n"));
    };
    refused("No such file");
    std::ofstream(path) << "title: no";
    refused("cannot be read");
    write_restart(path, {}, test::at_rest(test::wall(2, 1)));
    refused("is not a result of Talus");
    ResultsWriter(path, test::wall(2, 1), test::run_info());
    {
        h5::File file = h5::File::edit(path);
        file.set("/talus", "schema_version", std::int64_t{999});
        file.flush();
    }
    refused("version 999");
    std::filesystem::resize_file(path, std::filesystem::file_size(path) / 2);
    refused("truncated");
}

TEST_CASE("two runs cannot write one file at the same time") {
    const Folder folder;
    ResultsWriter writer(folder / "run.h5", test::wall(2, 1), test::run_info());
    CHECK_THROWS_WITH(ResultsWriter(folder / "run.h5", test::wall(2, 1), test::run_info()),
                      Catch::Contains("another process is writing it") || Catch::Contains("unable to"));
    writer.frame(test::wall(2, 1), test::at_rest(test::wall(2, 1)), {});
    CHECK(ResultsReader(folder / "run.h5").frames() == 1);
}
