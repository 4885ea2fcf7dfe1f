// What can go wrong, by whose fault. The library throws; the applications print and choose the exit code.
#pragma once

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace talus {

/// Where in a scenario file something stands: file name and 1-based line (0: not in a file, e.g. from the command line).
struct Where {
    std::string file;
    int line = 0;
};

/// One fault of the author of a scenario: `slope.yaml:14 joints.rough.friction: unknown key; did you mean ...`.
struct Fault {
    Where where;
    std::string key;      // path of the key, e.g. joints.rough.friction_angle_deg
    std::string message;  // what is wrong, what is allowed, nearest right spelling
    std::string text() const;
};

/// Everything wrong with what the user gave (scenario, result file, path), in one report. Exit code 2.
class InputError : public std::runtime_error {
public:
    explicit InputError(std::vector<Fault> faults);
    explicit InputError(const std::string& message);
    const std::vector<Fault>& faults() const { return faults_; }

private:
    std::vector<Fault> faults_;
};

/// The simulation left the range in which its numbers mean anything. Exit code 3.
class DivergenceError : public std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// A file could not be written in mid-run (disk full, folder gone). Exit code 4.
class OutputError : public std::runtime_error {
    using std::runtime_error::runtime_error;
};

}  // namespace talus
