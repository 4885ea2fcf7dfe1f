// One search, fed with recorded boxes as a run would feed it.
#pragma once

#include "contact/search.hpp"

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace talus {

/// A search by its name, or `read`: reads every box and finds nothing. No search that looks at all boxes can be faster.
std::unique_ptr<PairSearch> make_search_or_bound(const std::string& method);

/// A search by its name; throws InputError for a name that it does not know.
using MakeSearch = std::function<std::unique_ptr<PairSearch>(const std::string&)>;

class SearchReplay {
public:
    /// With a skin (m) the search gets boxes grown by it, and only when some box has left the one grown around it.
    SearchReplay(const MakeSearch& make, const std::string& method, int threads, double skin, std::size_t boxes);

    /// Brings the search up to date; false if that was not needed. `boxes` must stay where they are until the next call.
    bool advance(std::span<const Box> boxes);

    void use_my_threads() const;
    std::span<const Box> handed() const { return handed_; }  // boxes of the last update
    const PairSearch& search() const { return *search_; }

private:
    bool left(std::span<const Box> boxes) const;
    void grow(std::span<const Box> boxes);

    int threads_;
    double skin_;
    std::vector<Box> grown_;
    std::span<const Box> handed_;
    std::unique_ptr<PairSearch> search_;
};

}  // namespace talus
