// A tree of values against the specification: types, ranges, unknown and missing keys; defaults filled in.
#pragma once

#include "core/errors.hpp"
#include "scenario/shape.hpp"
#include "scenario/value.hpp"

#include <string>
#include <vector>

namespace talus {

/// The value with typed scalars and every default that does not depend on other keys. What is wrong is added to `faults` and
/// left out (in lists: `none`), so that the rest can still be looked at.
Value check(const Value& value, const spec::Shape& shape, const std::string& path, const std::string& file,
            std::vector<Fault>& faults);

/// Name of the file and the line; what came from the command line stands in no file.
Where place_of(const std::string& file, int line);

}  // namespace talus
