// The subcommands of `talus`. Each returns an exit code; what the user or the disk did wrong is thrown.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace talus::cli {

// 0; 1 expectation failed or equilibrium not reached; 2 anything the user gave; 3 diverged; 4 output failed in mid-run;
// 5 memory ran out, or a fault of ours; 130 interrupted
enum ExitCode { ok = 0, not_met = 1, bad_input = 2, diverged = 3, output_failed = 4, failed = 5, interrupted = 130 };

struct RunArguments {
    std::string scenario, output, case_name;
    std::vector<std::string> overrides;
    bool force = false, estimate_error = false;
};
int run_command(const RunArguments& arguments);
int resume_command(const std::string& results, int threads);

struct CheckArguments {
    std::string scenario, geometry;
    std::vector<std::string> overrides;
    bool resolved = false, schema = false, force = false;
};
int check_command(const CheckArguments& arguments);

struct VerifyArguments {
    std::string path;
    std::vector<std::string> overrides;
    std::string filter, csv;
    bool force = false;
};
int verify_command(const VerifyArguments& arguments);

struct BenchSearchArguments {
    std::vector<std::string> scenarios, trajectories, overrides, methods;
    std::vector<int> threads{1};
    std::vector<double> skins{0.0};  // m
    int steps = 200, every = 1, repeat = 5;
    std::string from, record, csv;
    std::optional<double> axes_deg;  // absent: as in a run
    bool no_check = false, check_direct = false, force = false;
};
int bench_search_command(const BenchSearchArguments& arguments);

struct BenchStepArguments {
    std::vector<std::string> scenarios, overrides;
    std::vector<int> threads{1};
    int steps = 200, repeat = 5;
    std::string from, csv;
    bool force = false;
};
int bench_step_command(const BenchStepArguments& arguments);

struct QueryArguments {
    std::string results;
    std::vector<std::string> at, in, along;  // "x,y", "x0,y0,x1,y1"
    std::optional<std::int64_t> frame;       // the last one if none is named
};
int query_command(const QueryArguments& arguments);

/// Reads lists of overrides from standard input, one in a line.
int resolve_command(const std::string& scenario);

int info_command(const std::string& results);
int export_command(const std::string& results, const std::string& folder);

}  // namespace talus::cli
