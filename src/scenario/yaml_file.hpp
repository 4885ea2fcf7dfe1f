// Text of a scenario -> tree of values. The only file that sees yaml-cpp.
#pragma once

#include "core/errors.hpp"
#include "scenario/value.hpp"

#include <string>
#include <vector>

namespace talus {

/// Reads one YAML document. Anchors and aliases work. Refused, with the line: syntax errors, duplicate keys, merge keys
/// (<<), several documents, keys that are not plain words. Faults that do not hide others are added to `faults`; a syntax
/// error is added and gives an empty value.
Value parse_yaml(const std::string& text, const std::string& file, std::vector<Fault>& faults);

}  // namespace talus
