// Each folder of src is a room; this table says which rooms it may enter and which file may see which library.
#include "support/catch.hpp"

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace fs = std::filesystem;

namespace {

const std::map<std::string, std::set<std::string>> may_enter = {
    {"core", {}},
    {"geometry", {"core"}},
    {"scenario", {"core"}},
    {"model", {"core", "geometry", "scenario"}},
    {"contact", {"core", "geometry", "model"}},
    {"dynamics", {"core", "geometry", "model"}},
    {"rigid", {"core", "geometry", "model", "contact"}},
    {"statics", {"core", "geometry", "model", "contact", "dynamics"}},
    {"verdict", {"core", "model"}},
    {"terms", {"core", "model"}},
    {"output", {"core", "model"}},
    {"simulation",
     {"core", "geometry", "scenario", "model", "contact", "dynamics", "rigid", "statics", "verdict", "terms", "output"}},
    {"apps", {"core", "scenario", "model", "output", "simulation"}},
};

// First folder of an include -> the one file (or folder) that may see the library.
const std::map<std::string, std::string> library_lives_in = {
    {"CGAL", "src/geometry/cut.cpp"},
    {"yaml-cpp", "src/scenario/yaml_file.cpp"},
    {"hdf5.h", "src/output/h5_file.cpp"},
    {"nlohmann", "src/scenario/"},
    {"CLI", "apps/"},
    {"catch2", "tests/support/"},
    {"boost", "apps/peers/"},
    {"box2d", "apps/peers/"},
    {"BulletCollision", "apps/peers/"},
    {"fcl", "apps/peers/"},
};

// Where other libraries are measured beside ours: it may see all of them, and the contact searches.
const std::string peers = "apps/peers/";

std::string room_of(const std::string& path) {  // src/contact/search.cpp -> contact; apps/talus/main.cpp -> apps
    std::vector<std::string> folders;
    for (const fs::path& folder : fs::path(path)) folders.push_back(folder);
    return folders[0] == "src" ? folders[1] : folders[0];
}

/// Why a file may not include something; empty if it may. `target` is what stands between the quotes or brackets.
std::string breach(const std::string& path, const std::string& target, bool quoted) {
    const std::string first = target.substr(0, target.find('/'));
    if (const auto library = library_lives_in.find(first); library != library_lives_in.end())
        return path.starts_with(library->second) || path.starts_with(peers) ? ""
                                                                            : first + " is for " + library->second + " only";
    const std::string room = room_of(path);
    if (!quoted || room == "tests" || first == room) return "";
    if (!may_enter.contains(room)) return "room " + room + " is not in the table";
    if (may_enter.at(room).contains(first) || (path.starts_with(peers) && first == "contact")) return "";
    return room == "apps" && target.find('/') == std::string::npos ? "" : room + " may not enter " + first;
}

/// All breaches in the text of one file, as `path:line: reason`.
std::vector<std::string> breaches(const std::string& path, std::istream& text) {
    static const std::regex include(R"(^\s*#\s*include\s*([<"])([^>"]+)[>"])");
    std::vector<std::string> found;
    std::string line;
    for (int number = 1; std::getline(text, line); ++number) {
        std::smatch match;
        if (!std::regex_search(line, match, include)) continue;
        const std::string reason = breach(path, match[2], match[1] == "\"");
        if (!reason.empty()) found.push_back(path + ":" + std::to_string(number) + ": " + reason);
    }
    return found;
}

}  // namespace

TEST_CASE("no file includes what its room may not enter") {
    const fs::path root = TALUS_SOURCE_DIR;
    int files = 0;
    for (const char* top : {"src", "apps", "tests"}) {
        if (!fs::exists(root / top)) continue;
        for (const auto& entry : fs::recursive_directory_iterator(root / top)) {
            if (entry.path().extension() != ".cpp" && entry.path().extension() != ".hpp") continue;
            std::ifstream text(entry.path());
            for (const std::string& b : breaches(fs::relative(entry.path(), root), text)) FAIL_CHECK(b);
            ++files;
        }
    }
    CHECK(files > 20);
}

TEST_CASE("a forbidden include is reported with file and line") {
    std::istringstream text(
        "#pragma once\n#include \"core/types.hpp\"\n#include \"contact/search.hpp\"\n#include <CGAL/x.h>\n");
    CHECK(breaches("src/output/frames.cpp", text) ==
          std::vector<std::string>{"src/output/frames.cpp:3: output may not enter contact",
                                   "src/output/frames.cpp:4: CGAL is for src/geometry/cut.cpp only"});
}

TEST_CASE("a room that the table does not know is reported") {
    std::istringstream text("#include \"core/types.hpp\"\n");
    CHECK(breaches("src/plumbing/pipe.cpp", text) ==
          std::vector<std::string>{"src/plumbing/pipe.cpp:1: room plumbing is not in the table"});
}
