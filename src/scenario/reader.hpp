// Scenario files: YAML -> Scenario, with every fault in one report.
#pragma once

#include "scenario/scenario.hpp"

#include <memory>
#include <string>
#include <vector>

namespace talus {

/// Reads a scenario file. Overrides are `path=value`, e.g. joints.bedding.friction_angle_deg=25, applied before anything
/// else. Throws InputError with all faults, by line. `cases` are looked at and left out.
Scenario read_scenario(const std::string& path, const std::vector<std::string>& overrides = {});

/// A file that is read once, and the scenarios that sets of overrides make of it.
class ScenarioFile {
public:
    /// Throws InputError if the file cannot be read or is no YAML.
    explicit ScenarioFile(const std::string& path);
    /// What read_scenario gives and throws.
    Scenario with(const std::vector<std::string>& overrides) const;

private:
    struct Content;
    std::shared_ptr<const Content> content_;
};

struct Case {
    std::string name;  // empty: the file has no cases
    Scenario scenario;
};

/// The scenario once for every row of `cases`, with the keys and expectations of the row; once if there are none.
std::vector<Case> read_cases(const std::string& path, const std::vector<std::string>& overrides = {});

/// The same from a text. The file name is for messages; paths in the scenario are relative to the folder. The canonical JSON
/// of a scenario is such a text, and gives the same scenario again.
Scenario read_scenario_text(const std::string& text, const std::string& file_name, const std::string& folder,
                            const std::vector<std::string>& overrides = {});
std::vector<Case> read_cases_text(const std::string& text, const std::string& file_name, const std::string& folder,
                                  const std::vector<std::string>& overrides = {});

/// JSON Schema (draft 2020-12) of scenario files, for editors.
std::string scenario_schema();

/// Tables of keys, shapes and quantities for docs/scenario-reference.md (Markdown).
std::string scenario_reference_tables();

}  // namespace talus
