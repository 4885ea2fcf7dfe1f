// Defaults that depend on other keys.
#pragma once

#include "scenario/value.hpp"

namespace talus {

/// Fills them into the tree as it was read, before the check: names by position, the only joint and the only material,
/// settling stages, trace lengths. What has a wrong form is left for the check to refuse.
void fill_derived_defaults(Value& scenario);

/// What is fixed unless the scenario has an accuracy, which decides it then. After the rows of `cases`, which may have one.
void fill_fixed_defaults(Value& scenario);

}  // namespace talus
