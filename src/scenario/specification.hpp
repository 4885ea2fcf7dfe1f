// Every key of a scenario file: kind, unit, default, range, meaning. The one source for the reader, the JSON Schema and the
// tables of docs/scenario-reference.md.
#pragma once

#include "scenario/shape.hpp"

namespace talus::spec {

const Shape& scenario();

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
