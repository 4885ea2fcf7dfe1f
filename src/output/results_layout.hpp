// The /talus part of a result file: what is written once, and the empty tables that grow.
#pragma once

#include "model/model.hpp"
#include "output/h5_file.hpp"

#include <cstdint>
#include <string>

namespace talus {

struct RunInfo;

inline const std::string frames_group = "/talus/frames/", energies_group = "/talus/energies/",
                         contacts_group = "/talus/contacts/", histories_group = "/talus/histories/",
                         statics_group = "/talus/statics/", verdict_group = "/talus/verdict";

/// As long as the longest status that may follow, so that it is overwritten in its place.
inline const std::string status_while_running = "in progress";

void create_talus_groups(h5::File& file, const Model& model, const RunInfo& info);

/// Keeps the first `frames` frames of motion, energies and contacts. Returns the number of contact rows left.
std::int64_t truncate_frames(h5::File& file, std::int64_t frames);

/// Frames that every table has in full; rows of a frame that was cut off do not count.
std::int64_t completed_frames(const h5::File& file);

/// Throws InputError unless the file is a result of this version of the layout.
void check_results_file(const h5::File& file);

std::string hash_text(std::uint64_t hash);       // 16 hexadecimal digits
std::int64_t contact_chunk(const Model& model);  // rows: about the contacts of one frame

}  // namespace talus
