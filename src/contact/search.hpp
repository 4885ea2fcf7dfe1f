// Contact search: boxes in, pairs out. Each method is one .cpp and one line in the table of names.
#pragma once

#include "core/types.hpp"

#include <memory>
#include <span>
#include <string>
#include <vector>

namespace talus {

/// Whether a box takes part: xmin > xmax marks an absent one, and a box whose numbers are not numbers counts as absent.
inline bool present(const Box& box) { return box.xmin <= box.xmax && box.ymin <= box.ymax; }

class PairSearch {
public:
    virtual ~PairSearch() = default;

    /// All pairs a < b whose closed boxes overlap (touching counts), sorted, each once. Depends on `boxes` alone:
    /// what a search remembers may make it faster, never different. A box that is not present overlaps nothing;
    /// the number of boxes may change between calls.
    virtual void find(std::span<const Box> boxes, std::vector<Pair>& pairs) = 0;
};

/// Names accepted by make_search, in the order in which they are documented.
std::span<const char* const> search_names();

/// Throws InputError for an unknown name, with the names allowed.
std::unique_ptr<PairSearch> make_search(const std::string& name);

}  // namespace talus
