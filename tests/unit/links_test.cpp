// The pages of the documentation lead somewhere: to files and headings that are there, and to sources that are listed.
#include "support/catch.hpp"

#include <cctype>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace fs = std::filesystem;

namespace {

const fs::path root = TALUS_SOURCE_DIR;

std::string read(const fs::path& path) {
    std::ostringstream text;
    text << std::ifstream(path).rdbuf();
    return text.str();
}

std::vector<fs::path> pages() {
    std::vector<fs::path> all{root / "README.md", root / "CHANGELOG.md"};
    for (const auto& entry : fs::directory_iterator(root / "docs"))
        if (entry.path().extension() == ".md") all.push_back(entry.path());
    return all;
}

std::vector<std::string> matches(const std::string& text, const std::regex& pattern) {
    std::vector<std::string> all;
    for (std::sregex_iterator at(text.begin(), text.end(), pattern), end; at != end; ++at) all.push_back((*at)[1]);
    return all;
}

// As code hosts name them: lower case, spaces to hyphens, everything else but letters, digits and _ dropped.
std::set<std::string> anchors(const std::string& page) {
    std::set<std::string> all;
    for (const std::string& heading : matches("\n" + page, std::regex("\n#+ ([^\n]+)"))) {
        std::string anchor;
        for (const unsigned char c : heading) {
            if (std::isalnum(c) != 0 || c == '_' || c == '-') anchor += static_cast<char>(std::tolower(c));
            if (c == ' ') anchor += '-';
        }
        all.insert(anchor);
    }
    return all;
}

}  // namespace

TEST_CASE("every relative link of the documentation leads to a file, and to a heading in it") {
    int seen = 0;
    for (const fs::path& page : pages()) {
        for (const std::string& link : matches(read(page), std::regex(R"(\]\(([^)\s]+)\))"))) {
            if (link.starts_with("http")) continue;
            ++seen;
            INFO(page.string() << " links to " << link);
            const std::string file = link.substr(0, link.find('#'));
            const fs::path target = file.empty() ? page : page.parent_path() / file;
            CHECK(fs::exists(target));
            if (const auto hash = link.find('#'); hash != std::string::npos)
                CHECK(anchors(read(target)).contains(link.substr(hash + 1)));
        }
    }
    CHECK(seen > 20);
}

TEST_CASE("every source that a page cites is in the list of references") {
    const std::vector<std::string> listed = matches(read(root / "docs/references.bib"), std::regex(R"(@\w+\{(\w+),)"));
    const std::set<std::string> keys(listed.begin(), listed.end());
    CHECK(keys.size() == listed.size());
    int seen = 0;
    for (const fs::path& page : pages()) {
        for (const std::string& group : matches(read(page), std::regex(R"(\[([a-z]+[0-9]{4}(?:, [a-z]+[0-9]{4})*)\])"))) {
            for (const std::string& key : matches(group, std::regex("([a-z]+[0-9]{4})"))) {
                INFO(page.string() << " cites " << key);
                CHECK(keys.contains(key));
                ++seen;
            }
        }
    }
    CHECK(seen > 10);
}
