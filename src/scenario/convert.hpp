// Checked tree -> Scenario, one function per section of the file. Each also looks at what no key can tell alone: names,
// outlines, keys that belong together. Faults go into the reading; what comes out after a fault is not for use.
#pragma once

#include "scenario/cursor.hpp"
#include "scenario/scenario.hpp"

namespace talus {

std::vector<MaterialSpec> convert_materials(const Cursor& materials);
JointSpec convert_joint(const std::string& name, const Cursor& joint);
ContactSpec convert_contacts(const Cursor& contacts);
std::vector<LoadSpec> convert_loads(const Cursor& loads);
Selector convert_selector(const Cursor& selector);
InitialStressSpec convert_initial_stress(const Cursor& stress);
RockSpec convert_rock(const Cursor& rock);
std::vector<BlockSpec> convert_blocks(const Cursor& blocks);
std::vector<StageSpec> convert_stages(const Cursor& scenario);
RunSpec convert_run(const Cursor& run);
RecordSpec convert_record(const Cursor& record);
std::vector<ExpectSpec> convert_expect(const Cursor& expect);

/// Name of a block, of repeated blocks or of a region; else a fault with the nearest one.
std::string convert_block_name(const Cursor& name);

/// Faults for what the named solvers cannot represent.
void check_solvers(const Scenario& scenario, const Cursor& at);

/// Everything but text, canonical JSON and hash. Coordinates are relative to the origin of the reading.
Scenario convert(const Cursor& scenario);

}  // namespace talus
