#include "commands.hpp"

#include "core/errors.hpp"
#include "output/results_layout.hpp"
#include "scenario/reader.hpp"
#include "scenario/yaml_file.hpp"

#include <cstdio>
#include <iostream>

namespace talus::cli {
namespace {

Value texts(const std::vector<Fault>& faults) {
    std::vector<Value> all;
    for (const Fault& fault : faults) all.push_back(Value::of_text(fault.text()));
    return Value::of_list(std::move(all));
}

// `["a.b=1", "c=[1, 2]"]`: JSON, or any list that YAML writes in one line.
std::vector<std::string> overrides_in(const std::string& line) {
    std::vector<Fault> faults;
    const Value list = parse_yaml(line, "standard input", faults);
    if (!faults.empty()) throw InputError(std::move(faults));
    std::vector<std::string> all;
    for (const Value& item : list.items) all.push_back(item.text);
    if (!list.is(Value::Kind::list))
        throw InputError("expected a list of path=value in each line, e.g. [\"run.until.time=2\"]");
    return all;
}

}  // namespace

int resolve_command(const std::string& scenario) {
    const ScenarioFile file(scenario);
    int code = ok;
    for (std::string line; std::getline(std::cin, line);) {
        Value answer = Value::of_map();
        try {
            answer.set("hash", Value::of_text(hash_text(file.with(overrides_in(line)).hash)));
        } catch (const InputError& error) {
            answer.set("faults", texts(error.faults()));
            code = bad_input;
        }
        std::printf("%s\n", to_json(answer).c_str());
        std::fflush(stdout);  // who asks one by one waits for it
    }
    return code;
}

}  // namespace talus::cli
