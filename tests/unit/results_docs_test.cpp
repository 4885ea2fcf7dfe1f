// docs/results-format.md names every dataset of a result file with its type and unit, and no other.
#include "support/catch.hpp"
#include "support/folder.hpp"
#include "support/small_run.hpp"

#include <algorithm>
#include <fstream>
#include <map>
#include <sstream>

using namespace talus;

namespace {

struct Described {
    std::string type, unit;
};

std::string trimmed(const std::string& text) {
    const auto first = text.find_first_not_of(" `"), last = text.find_last_not_of(" `");
    return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

/// Rows of the tables whose first cell is a path: | `/path` | shape | type | unit | meaning |
std::map<std::string, Described> page() {
    std::ifstream file(TALUS_SOURCE_DIR "/docs/results-format.md");
    REQUIRE(file);
    std::map<std::string, Described> rows;
    for (std::string line; std::getline(file, line);) {
        if (line.rfind("| `/", 0) != 0) continue;
        std::vector<std::string> cells;
        std::stringstream stream(line);
        for (std::string cell; std::getline(stream, cell, '|');) cells.push_back(trimmed(cell));
        REQUIRE(cells.size() >= 5);
        REQUIRE(rows.emplace(cells[1], Described{cells[3], cells[4]}).second);
    }
    return rows;
}

/// Histories are named by the scenario; the page has a star in these places.
std::string as_on_page(const std::string& path) {
    const std::string histories = "/talus/histories/";
    if (path.rfind(histories, 0) != 0) return path;
    return histories + (path.substr(path.rfind('/')) == "/time" ? "*/time" : "*/*");
}

}  // namespace

TEST_CASE("the page on the results format names every dataset with its type and unit, and none that does not exist") {
    const Model model = test::l_and_square();
    const test::Folder folder;
    {
        ResultsWriter writer(folder / "run.h5", model, test::run_info());
        test::write_frame(writer, model, test::add_toe(writer), 0);
        RunSummary summary;
        summary.statics.now.iterations = summary.statics.now.newton_steps = 1;
        summary.statics.newton_ratios = {1e-9};
        summary.verdict.emplace().block_mechanism.resize(model.blocks.size());
        writer.finish(summary);
    }
    const h5::File file = h5::File::open(folder / "run.h5");
    auto described = page();
    std::map<std::string, int> seen;
    for (const std::string& path : file.datasets()) {
        INFO(path);
        const auto row = described.find(as_on_page(path));
        REQUIRE(row != described.end());
        CHECK(row->second.type == file.type_name(path));
        if (row->first != "/talus/histories/*/*") CHECK(row->second.unit == file.text(path, "unit"));
        CHECK_FALSE(file.text(path, "shape").empty());
        ++seen[row->first];
    }
    for (const auto& [path, row] : described) {
        INFO(path);
        CHECK(seen[path] > 0);
    }
}

TEST_CASE("the page on the results format names every attribute of /talus and of the verdict") {
    const Model model = test::l_and_square();
    const test::Folder folder;
    {
        ResultsWriter writer(folder / "run.h5", model, test::run_info());
        RunSummary summary;
        summary.verdict.emplace();
        writer.finish(summary);
    }
    std::stringstream text;
    text << std::ifstream(TALUS_SOURCE_DIR "/docs/results-format.md").rdbuf();
    for (const std::string group : {"/talus", "/talus/verdict"})
        for (const std::string& name : h5::File::open(folder / "run.h5").attributes(group)) {
            INFO(name);
            CHECK(text.str().find("`" + name + "`") != std::string::npos);
        }
}
