#include "commands.hpp"
#include "scenario_files.hpp"
#include "summary.hpp"

#include "core/errors.hpp"
#include "scenario/reader.hpp"
#include "simulation/run.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>

namespace talus::cli {
namespace {

struct Tally {
    int cases = 0, checks = 0, failed_cases = 0;
};

void verify_case(const std::string& file, const Case& row, Tally& tally) {
    Stopwatch clock;
    int failed = 0;
    std::string trouble;
    std::vector<Verdict> verdicts;
    try {
        Simulation simulation(row.scenario, build(row.scenario));
        Watch watch(row.scenario.expect, simulation.model(), simulation.first_state());
        RunOptions options;
        options.watch = &watch;
        options.out_of_time = [&](const Simulation& s) { trouble = out_of_time(s); };
        run(simulation, options);
        verdicts = watch.judge();
    } catch (const DivergenceError& error) {
        trouble = std::string("diverged: ") + error.what();
    } catch (const InputError& error) {
        trouble = error.what();
    }
    failed = static_cast<int>(std::count_if(verdicts.begin(), verdicts.end(), [](const Verdict& v) { return !v.passed; }));
    const bool bad = failed > 0 || !trouble.empty();
    std::printf("%s %s%s%s  (%.2f s)%s%s\n", bad ? "FAILED" : "ok    ", std::filesystem::path(file).stem().c_str(),
                row.name.empty() ? "" : " / ", row.name.c_str(), clock.seconds(), trouble.empty() ? "" : ": ",
                trouble.c_str());
    print_verdicts(verdicts, "    ");
    std::fflush(stdout);
    ++tally.cases;
    tally.checks += static_cast<int>(verdicts.size());
    tally.failed_cases += bad;
}

}  // namespace

int verify_command(const VerifyArguments& arguments) {
    if (!std::filesystem::exists(arguments.path)) throw InputError(arguments.path + ": no such file or folder");
    Tally tally;
    Stopwatch clock;
    for (const std::string& file : scenario_files(arguments.path))
        for (const Case& row : read_cases(file, arguments.overrides)) {
            const std::string name = std::filesystem::path(file).stem().string() + " / " + row.name;
            if (row.scenario.expect.empty() || name.find(arguments.filter) == std::string::npos) continue;
            verify_case(file, row, tally);
        }
    std::printf("%d cases, %d expectations, %d cases failed, %.1f s\n", tally.cases, tally.checks, tally.failed_cases,
                clock.seconds());
    if (tally.cases == 0) throw InputError(arguments.path + ": no scenario there says what it expects (`expect:`)");
    return tally.failed_cases > 0 ? not_met : ok;
}

}  // namespace talus::cli
