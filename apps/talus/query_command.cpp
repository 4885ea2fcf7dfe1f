#include "commands.hpp"
#include "summary.hpp"

#include "core/errors.hpp"
#include "core/text.hpp"
#include "model/query.hpp"
#include "output/snapshot.hpp"

#include <charconv>
#include <cmath>
#include <cstdio>

namespace talus::cli {
namespace {

std::vector<double> numbers(const std::string& option, const std::string& text, std::size_t count) {
    std::vector<double> all;
    const char *at = text.data(), *end = at + text.size();
    for (bool more = true; more;) {
        double value = 0.0;
        const auto [stop, error] = std::from_chars(at, end, value);
        if (error != std::errc() || !std::isfinite(value) || (stop != end && *stop != ',')) {
            all.clear();
            break;
        }
        all.push_back(value);
        more = stop != end;
        at = stop + 1;
    }
    if (all.size() == count) return all;
    throw InputError(option + ": needs " + std::to_string(count) + " numbers with commas between, m; not `" + text + "`");
}

void print_block(const Snapshot& s, BlockId b) {
    const std::string name = s.name[b].empty() ? "" : " `" + s.name[b] + "`";
    std::printf("block %d%s at %s", b, name.c_str(), place(s.position[b] + s.origin, std::sqrt(s.area[b])).c_str());
}

void print_blocks(const Snapshot& s, const std::vector<BlockId>& blocks) {
    for (const BlockId b : blocks) print_block(s, b), std::printf("\n");
}

}  // namespace

int query_command(const QueryArguments& arguments) {
    const std::size_t questions = arguments.at.size() + arguments.in.size() + arguments.along.size();
    if (questions == 0) throw InputError("query needs --at, --in or --along");
    const Snapshot s = read_snapshot(arguments.results, arguments.frame);
    const BlockQuery query(s.parts, s.corners, s.position, s.angle, s.removed);
    const auto local = [&](double x, double y) { return Vec2(Vec2(x, y) - s.origin); };
    for (const std::string& text : arguments.at) {
        const std::vector<double> n = numbers("--at", text, 2);
        print_blocks(s, query.at(local(n[0], n[1])));
    }
    for (const std::string& text : arguments.in) {
        const std::vector<double> n = numbers("--in", text, 4);
        const Vec2 a = local(n[0], n[1]), b = local(n[2], n[3]), low = a.cwiseMin(b), high = a.cwiseMax(b);
        print_blocks(s, query.in({low.x(), low.y(), high.x(), high.y()}));
    }
    for (const std::string& text : arguments.along) {
        const std::vector<double> n = numbers("--along", text, 4);
        for (const BlockQuery::Hit& hit : query.along(local(n[0], n[1]), local(n[2], n[3]))) {
            print_block(s, hit.block);
            std::printf(", inside from %s to %s\n", number(hit.entry, "m").c_str(), number(hit.exit, "m").c_str());
        }
    }
    return ok;
}

}  // namespace talus::cli
