#include "scenario/trace_file.hpp"

#include "core/errors.hpp"
#include "scenario/reader.hpp"
#include "support/catch.hpp"

#include <filesystem>
#include <fstream>

using namespace talus;

namespace {

std::string written(const std::string& name, const std::string& text) {
    const auto folder = std::filesystem::temp_directory_path() / "talus_trace_file_test";
    std::filesystem::create_directories(folder);
    const std::string file = (folder / name).string();
    std::ofstream(file) << text;
    return file;
}

template <class F>
std::string fault(F f) {
    try {
        f();
    } catch (const InputError& e) {
        return e.what();
    }
    return "no fault";
}

bool names(const std::string& message, const std::string& part) { return message.find(part) != message.npos; }

}  // namespace

TEST_CASE("lines of a GeoJSON map are read with all their digits") {
    const auto traces = read_traces(written("map.geojson", R"({"type": "FeatureCollection", "features": [
        {"type": "Feature", "properties": {}, "geometry":
            {"type": "LineString", "coordinates": [[465993.935499999672174, 6691596.80159999989], [465995.5, 6691598.25, 12.0]]}},
        {"type": "Feature", "properties": null, "geometry": null},
        {"type": "Feature", "properties": {}, "geometry": {"type": "Point", "coordinates": [1, 2]}},
        {"type": "Feature", "properties": {}, "geometry":
            {"type": "MultiLineString", "coordinates": [[[0, 0], [1, 0], [1, 1]], [[5, 5], [6, 6]], [[7, 7]]]}}]})"));
    REQUIRE(traces.size() == 3);
    CHECK(traces[0] == std::vector<Vec2>{{465993.935499999672174, 6691596.80159999989}, {465995.5, 6691598.25}});
    CHECK(traces[1] == std::vector<Vec2>{{0, 0}, {1, 0}, {1, 1}});
    CHECK(traces[2] == std::vector<Vec2>{{5, 5}, {6, 6}});
}

TEST_CASE("a table of points gives one polyline per id") {
    const auto traces = read_traces(written("map.csv", "id,x,y\r\na,0,0\r\nb,1e3,-2.5\r\na, 1 ,2\r\n\r\nb,\"1001\",0\r\n"));
    REQUIRE(traces.size() == 2);
    CHECK(traces[0] == std::vector<Vec2>{{0, 0}, {1, 2}});
    CHECK(traces[1] == std::vector<Vec2>{{1000, -2.5}, {1001, 0}});
}

TEST_CASE("the outline is the first ring of the polygon, open and counter-clockwise") {
    const Polygon outline = read_outline(written("area.geojson", R"({"type": "Feature", "geometry": {"type": "Polygon",
        "coordinates": [[[0, 0], [0, 2], [3, 2], [3, 0], [0, 0]], [[1, 1], [1.5, 1], [1.5, 1.5], [1, 1]]]}})"));
    CHECK(outline == Polygon{{3, 0}, {3, 2}, {0, 2}, {0, 0}});
}

TEST_CASE("a file that gives no lines says its name and why") {
    const auto traces = [](const std::string& file) { return fault([&] { read_traces(file); }); };
    CHECK(names(traces("no/such/map.geojson"), "no/such/map.geojson cannot be read"));
    CHECK(names(traces(written("broken.geojson", "{\"type\": ")), "broken.geojson is not valid JSON"));
    CHECK(names(traces(written("empty.geojson", "")), "empty.geojson cannot be read, or is empty"));
    CHECK(names(traces(written("points.geojson", R"({"type": "Point", "coordinates": [1, 2]})")), "has no lines"));
    CHECK(names(traces(written("text.geojson", R"({"type": "LineString", "coordinates": [["a", "b"], [1, 2]]})")),
                "text.geojson is not valid GeoJSON"));
    CHECK(names(traces(written("header.csv", "a,b\n1,2\n")), "header.csv:1 the first line must be id,x,y"));
    CHECK(names(traces(written("word.csv", "id,x,y\n1,2,3\n1,2,three\n")), "word.csv:3 'three' is not a number"));
    CHECK(names(traces(written("short.csv", "id,x,y\n1,2\n")), "short.csv:2 needs three columns"));
    CHECK(names(traces(written("single.csv", "id,x,y\n1,2,3\n")), "single.csv has no lines"));

    const auto outline = [](const std::string& file) { return fault([&] { read_outline(file); }); };
    CHECK(names(outline(written("line.geojson", R"({"type": "LineString", "coordinates": [[0, 0], [1, 2]]})")), "has 0"));
    CHECK(names(outline(written("two.geojson", R"({"type": "MultiPolygon", "coordinates":
        [[[[0, 0], [1, 0], [1, 1], [0, 0]]], [[[5, 0], [6, 0], [6, 1], [5, 0]]]]})")),
                "has 2"));
}

TEST_CASE("the hash of a scenario tells two contents of a trace file apart") {
    const std::string map = "id,x,y\na,0,1\na,4,1\n";
    const std::string file = written("hashed.csv", map);
    const std::string text =
        "materials: {rock: {density: 2500}}\njoints: {plain: {normal_stiffness: 1e9, shear_stiffness: 5e8}}\n"
        "rock: {outline: [[0, 0], [4, 0], [4, 3], [0, 3]], traces: {file: hashed.csv}}\nrun: {until: {time: 1}}\n";
    const auto read = [&] {
        return read_scenario_text(text, "scene.yaml", std::filesystem::path(file).parent_path().string());
    };
    const Scenario before = read();
    REQUIRE(before.files.size() == 1);
    CHECK(before.files[0].first == "hashed.csv");
    CHECK(read().hash == before.hash);
    written("hashed.csv", map + "b,2,1\nb,2,3\n");
    const Scenario after = read();
    CHECK(after.canonical_json == before.canonical_json);
    CHECK(after.hash != before.hash);
    CHECK(after.files[0].second != before.files[0].second);
}
