#include "search_table.hpp"

#include "progress.hpp"

#include "output/whole_file.hpp"

#include <cstdio>

namespace talus::cli {
namespace {

void print(const SearchCost& c) {
    const std::string wrong = c.wrong_steps ? std::to_string(*c.wrong_steps) : "-";
    std::printf("  %-16s %3d %7.4g %9.3g %9.3g %9.3g %9.3g %9.3g %9.3g %9.3g %8.3g %7.3g %7.0f %6s%s%s\n", c.method.c_str(),
                c.threads, c.skin, c.median, c.q1, c.q3, c.mean, c.max, c.first, c.list, c.exchanges, c.pairs, c.bytes,
                wrong.c_str(), c.choice.empty() ? "" : "  ", c.choice.c_str());
}

}  // namespace

SearchBench within_reach(SearchBench bench, std::size_t boxes,
                         const std::function<std::size_t(const std::string&)>& largest) {
    std::string left_out;
    std::erase_if(bench.methods, [&](const std::string& method) {
        if (boxes <= largest(method)) return false;
        left_out += (left_out.empty() ? "" : ", ") + method;
        return true;
    });
    if (!left_out.empty())
        std::printf("  left out, too slow for %zu boxes: %s (name them in --methods to have them)\n", boxes,
                    left_out.c_str());
    return bench;
}

SearchTable time_and_print(const std::string& scene, const Trajectory& trajectory, const SearchBench& bench) {
    std::printf("%s: %zu boxes, %zu steps\n", scene.c_str(), trajectory.boxes, trajectory.steps());
    StatusLine line;
    SearchTable table{scene, trajectory.boxes, trajectory.steps(),
                      time_searches(trajectory, bench, [&](const std::string& now) { line.show(scene + ": " + now); })};
    line.clear();
    std::printf("  ns per box and step\n  %-16s %3s %7s %9s %9s %9s %9s %9s %9s %9s %8s %7s %7s %6s\n", "method", "thr",
                "skin", "median", "q1", "q3", "mean", "max", "first", "list", "exch", "pairs", "bytes", "wrong");
    for (const SearchCost& cost : table.costs) print(cost);
    std::fflush(stdout);
    return table;
}

void write_search_tables(const std::string& path, const std::vector<SearchTable>& tables) {
    write_whole_file(path, [&](std::ostream& file) {
        file
            << "scene,boxes,steps,method,threads,skin,ns_per_box_median,ns_per_box_q1,ns_per_box_q3,ns_per_box_mean,"
               "ns_per_box_max,first_ns_per_box,list_ns_per_box,exchanges_per_box,pairs_per_box,bytes_per_box,wrong_steps\n";
        for (const SearchTable& t : tables)
            for (const SearchCost& c : t.costs) {
                file << t.scene << ',' << t.boxes << ',' << t.steps << ',' << c.method << ',' << c.threads << ',' << c.skin;
                for (const double x : {c.median, c.q1, c.q3, c.mean, c.max, c.first, c.list, c.exchanges, c.pairs, c.bytes})
                    file << ',' << x;
                file << ',';
                if (c.wrong_steps) file << *c.wrong_steps;
                file << '\n';
            }
    });
}

}  // namespace talus::cli
