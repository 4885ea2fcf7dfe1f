#include "commands.hpp"
#include "scenario_files.hpp"
#include "summary.hpp"

#include "core/errors.hpp"
#include "output/output_path.hpp"
#include "scenario/reader.hpp"
#include "simulation/trial.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>

namespace talus::cli {
namespace {

std::string quoted(std::string text) {
    for (std::size_t at = 0; (at = text.find('"', at)) != std::string::npos; at += 2) text.insert(at, 1, '"');
    std::replace(text.begin(), text.end(), '\n', ' ');
    return '"' + text + '"';
}

// One row for each expectation. `method` is what computes: the solver, and the geometry of its contacts.
class Table {
public:
    explicit Table(const std::string& path) {
        if (path.empty()) return;
        file_.open(path);
        if (!file_) throw InputError(path + ": cannot be written");
        file_.precision(std::numeric_limits<double>::max_digits10);
        file_ << "file,title,case,method,quantity,measured,asked,bar,allowed,passed,trouble,seconds\n";
    }
    void add(const std::string& file, const Case& row, const Trial& trial, double seconds) {
        if (!file_.is_open()) return;
        for (const Verdict& v : trial.verdicts)
            file_ << quoted(std::filesystem::path(file).stem().string()) << ',' << quoted(row.scenario.title) << ','
                  << quoted(row.name) << ',' << quoted(method(row.scenario, trial)) << ',' << quoted(v.what) << ','
                  << v.measured << ',' << v.asked << ',' << v.expected << ',' << v.allowed << ',' << v.passed << ','
                  << quoted(trial.trouble) << ',' << seconds << '\n';
        file_.flush();
    }

private:
    static std::string method(const Scenario& scenario, const Trial& trial) {
        if (scenario.run.rounding_length) return trial.solver + " rounded";
        return scenario.run.face_path ? trial.solver : trial.solver + " general";
    }
    std::ofstream file_;
};

void print_case(const std::string& file, const Case& row, const Trial& trial, double seconds) {
    std::printf("%s %s%s%s  (%.2f s)%s%s\n", trial.passed() ? "ok    " : "FAILED",
                std::filesystem::path(file).stem().c_str(), row.name.empty() ? "" : " / ", row.name.c_str(), seconds,
                trial.trouble.empty() ? "" : ": ", trial.trouble.c_str());
    print_verdicts(trial.verdicts, "    ");
    std::fflush(stdout);
}

// Tries the cases of one file; those that are only needed to compare others with them say nothing.
class FileTrial {
public:
    FileTrial(const std::string& file, const std::vector<std::string>& overrides) : rows_(read_cases(file, overrides)) {}
    const std::vector<Case>& rows() const { return rows_; }
    const Trial& operator()(const Case& row) {
        for (const ExpectSpec& expect : row.scenario.expect)
            for (const Case& other : rows_)
                if (other.name == expect.same_as && !expect.same_as.empty() && !tried_.contains(other.name)) (*this)(other);
        return tried_[row.name] = try_out(row.scenario, tried_);
    }

private:
    std::vector<Case> rows_;
    std::map<std::string, Trial> tried_;
};

}  // namespace

int verify_command(const VerifyArguments& arguments) {
    if (!std::filesystem::exists(arguments.path)) throw InputError(arguments.path + ": no such file or folder");
    const std::string csv = arguments.csv.empty() ? "" : choose_output_path(arguments.csv, arguments.force);
    Table table(csv);
    int cases = 0, checks = 0, failed = 0;
    Stopwatch clock;
    for (const std::string& file : scenario_files(arguments.path)) {
        FileTrial try_case(file, arguments.overrides);
        for (const Case& row : try_case.rows()) {
            const std::string name = std::filesystem::path(file).stem().string() + " / " + row.name;
            if (row.scenario.expect.empty() || name.find(arguments.filter) == std::string::npos) continue;
            Stopwatch watch;
            const Trial& trial = try_case(row);
            const double seconds = watch.seconds();
            print_case(file, row, trial, seconds);
            table.add(file, row, trial, seconds);
            ++cases;
            checks += static_cast<int>(trial.verdicts.size());
            failed += !trial.passed();
        }
    }
    std::printf("%d cases, %d expectations, %d cases failed, %.1f s\n", cases, checks, failed, clock.seconds());
    if (!csv.empty()) std::printf("table in %s\n", csv.c_str());
    if (cases == 0) throw InputError(arguments.path + ": no scenario there says what it expects (`expect:`)");
    return failed > 0 ? not_met : ok;
}

}  // namespace talus::cli
