// The word somebody may have meant.
#pragma once

#include <string>
#include <vector>

namespace talus {

/// Word of `known` nearest to `word` by letters; words that contain each other are near, and so are common symbols (kn, ks,
/// phi). Empty if nothing is near.
std::string nearest(const std::string& word, const std::vector<std::string>& known);

/// `; did you mean "near"?`, or `; known: a, b, c`, or nothing when there is nothing to say.
std::string hint(const std::string& word, const std::vector<std::string>& known);

/// a, b, c
std::string enumerate(const std::vector<std::string>& words, const std::string& separator = ", ");

}  // namespace talus
