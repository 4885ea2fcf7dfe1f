#include "scenario/yaml_file.hpp"

#include <yaml-cpp/yaml.h>

#include <map>

namespace talus {
namespace {

class Parser {
public:
    Parser(const std::string& file, std::vector<Fault>& faults) : file_(file), faults_(faults) {}

    Value convert(const YAML::Node& node, const std::string& path, int line, int depth) {
        if (node.Mark().line >= 0 && !node.Mark().is_null()) line = node.Mark().line + 1;  // yaml-cpp counts from 0
        // An alias may stand inside its own anchor, or anchors may multiply each other: both would fill the memory.
        if (depth > 100 || ++count_ > 20'000'000)
            throw InputError({Fault{{file_, line}, path, "nested too deeply (an alias inside its own anchor?)"}});
        Value value;
        value.line = line;
        if (node.IsScalar()) {
            value.kind = Value::Kind::raw;
            value.text = node.Scalar();
            value.quoted = node.Tag() == "!";
        } else if (node.IsSequence()) {
            value.kind = Value::Kind::list;
            value.items.reserve(node.size());
            for (const YAML::Node& item : node)
                value.items.push_back(convert(item, path + "[" + std::to_string(value.items.size()) + "]", line, depth + 1));
        } else if (node.IsMap()) {
            value.kind = Value::Kind::map;
            convert_map(node, path, depth, value);
        }
        return value;
    }

private:
    void convert_map(const YAML::Node& node, const std::string& path, int depth, Value& value) {
        std::map<std::string, int> seen;
        for (const auto& pair : node) {
            const int line = pair.first.Mark().line + 1;
            if (!pair.first.IsScalar()) {
                faults_.push_back({{file_, line}, path, "a key must be a plain word"});
                continue;
            }
            const std::string key = pair.first.Scalar();
            const std::string key_path = path.empty() ? key : path + "." + key;
            if (key == "<<") {
                faults_.push_back({{file_, line}, key_path, "merge keys are not supported; write the keys out"});
            } else if (const auto [first, fresh] = seen.try_emplace(key, line); !fresh) {
                faults_.push_back({{file_, line}, key_path, "given twice; first in line " + std::to_string(first->second)});
            } else {
                value.entries.push_back({key, line, convert(pair.second, key_path, line, depth + 1)});
                value.entries.back().value.line = line;  // of the key: where a reader looks for the fault
            }
        }
    }

    const std::string& file_;
    std::vector<Fault>& faults_;
    long count_ = 0;
};

}  // namespace

Value parse_yaml(const std::string& text, const std::string& file, std::vector<Fault>& faults) {
    try {
        const std::vector<YAML::Node> documents = YAML::LoadAll(text);
        if (documents.size() > 1)
            faults.push_back(
                {{file, documents[1].Mark().line + 1}, {}, "a second document (---); one file holds one scenario"});
        if (!documents.empty()) return Parser(file, faults).convert(documents[0], {}, 1, 0);
        Value nothing;
        nothing.line = 1;
        return nothing;
    } catch (const YAML::Exception& error) {
        faults.push_back({{file, error.mark.line + 1}, {}, "not valid YAML: " + error.msg});
    } catch (const InputError& error) {
        faults.insert(faults.end(), error.faults().begin(), error.faults().end());
    }
    return {};
}

}  // namespace talus
