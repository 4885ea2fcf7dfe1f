// Every key of a scenario file: kind, unit, default, range, meaning. The one source for the reader, the JSON Schema and the
// tables of docs/scenario-reference.md.
#pragma once

#include "scenario/shape.hpp"

namespace talus::spec {

/// With a `run.accuracy`, which decides what joints do not say of their stiffness.
const Shape& scenario();
/// The stiffness of joints must be given.
const Shape& scenario_without_accuracy();

// Parts of it, one function per section of the file.
Shape point();
Shape outline();
Shape region();
Shape time_table(const std::string& unit);
Shape vector_table(const std::string& unit);
Shape selector();
Shape load();
Shape joint();
Shape joint_change();
Shape rock();
Shape block();
Shape stage();
Shape run();
Shape record();
Shape expectation();

}  // namespace talus::spec
