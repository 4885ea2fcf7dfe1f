// The right word for a misspelt one, for reports of faults.
#pragma once

#include <span>
#include <string_view>

namespace talus {

/// Fewest letters to insert, delete or replace to turn one word into the other (Levenshtein 1966).
int edit_distance(std::string_view a, std::string_view b);

/// The allowed word nearest to `word`, the first of equals; empty when none is near enough to be what was meant.
std::string_view nearest_spelling(std::string_view word, std::span<const std::string_view> allowed);

}  // namespace talus
