// Values changed by path before the file is looked at: `--set a.b[0].c=value`, and the rows of `cases`.
#pragma once

#include "core/errors.hpp"
#include "scenario/shape.hpp"
#include "scenario/value.hpp"

#include <string>
#include <vector>

namespace talus {

struct Override {
    std::string path;  // a.b[0].c, or a.b.0.c
    Value value;
    std::string key;  // what a fault calls it: the path, or cases[2].set.path
};

/// `a.b=value`, the value read as YAML. A fault if it is not of this form.
std::vector<Override> parse_overrides(const std::vector<std::string>& texts, std::vector<Fault>& faults);

/// Puts the value into the tree. Keys that the specification allows are created, with the tables around them; names and
/// items of lists must be there. A path that leads nowhere is a fault with the nearest right key.
void apply(const Override& change, const spec::Shape& shape, const std::string& file, Value& tree,
           std::vector<Fault>& faults);

}  // namespace talus
