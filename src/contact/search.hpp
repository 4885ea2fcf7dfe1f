// Contact search: boxes in, pairs out. Each method is one .cpp and one line in the table of names.
#pragma once

#include "core/types.hpp"

#include <cstdint>
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

    /// Brings the set of pairs up to date: afterwards it holds every a < b whose closed boxes overlap (touching counts), and
    /// no other. It depends on `boxes` alone: what a search remembers may make it faster, never different. A box that is
    /// not present overlaps nothing; the number of boxes may change between calls.
    virtual void update(std::span<const Box> boxes) = 0;

    /// Writes the set of the last update, sorted, each pair once.
    virtual void pairs(std::vector<Pair>& pairs) const = 0;

    /// How often two ends changed places since the search was made; 0 for methods that do not sort.
    virtual std::int64_t exchanges() const { return 0; }

    /// In words, what a search that chooses its way has chosen; empty for those that have one way only.
    virtual std::string choice() const { return {}; }

    void find(std::span<const Box> boxes, std::vector<Pair>& found) {
        update(boxes);
        pairs(found);
    }
};

/// Names accepted by make_search, in the order in which they are documented.
std::span<const char* const> search_names();

/// Throws InputError for an unknown name, with the names allowed.
std::unique_ptr<PairSearch> make_search(const std::string& name);

}  // namespace talus
