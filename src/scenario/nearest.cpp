#include "scenario/nearest.hpp"

#include "core/spelling.hpp"

#include <algorithm>
#include <cctype>
#include <map>

namespace talus {
namespace {

// What other programs and textbooks call our keys.
const std::map<std::string, std::vector<std::string>> symbols = {
    {"kn", {"normal_stiffness"}},
    {"jkn", {"normal_stiffness"}},
    {"ks", {"shear_stiffness"}},
    {"jks", {"shear_stiffness"}},
    {"phi", {"friction_angle_deg"}},
    {"mu", {"friction_angle_deg"}},
    {"c", {"cohesion"}},
    {"rho", {"density"}},
    {"dip", {"angle_deg"}},
    {"dip_deg", {"angle_deg"}},
    {"dt", {"time_step"}},
    {"fixed", {"held"}},
    {"polygon", {"outline"}},
    {"vertices", {"outline"}},
    {"psi", {"dilation_angle_deg"}},
    {"omega", {"spin"}},
    {"force", {"normal_force", "shear_force", "reaction"}},
};

std::string lower(std::string word) {
    for (char& c : word) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return word;
}

int farness(const std::string& word, const std::string& candidate) {
    const int d = edit_distance(word, candidate);
    const bool contained = word.size() >= 3 && candidate.size() >= 3 &&
                           (candidate.find(word) != candidate.npos || word.find(candidate) != word.npos);
    return contained ? std::min(d, 2) : d;
}

}  // namespace

std::string nearest(const std::string& word, const std::vector<std::string>& known) {
    const std::string wanted = lower(word);
    if (const auto symbol = symbols.find(wanted); symbol != symbols.end())
        for (const std::string& name : symbol->second)
            if (std::find(known.begin(), known.end(), name) != known.end()) return name;
    std::string best;
    int least = wanted.size() < 3 ? 2 : std::max(2, static_cast<int>(wanted.size()) / 3) + 1;
    for (const std::string& candidate : known)
        if (const int d = farness(wanted, lower(candidate)); d < least) least = d, best = candidate;
    return best;
}

std::string hint(const std::string& word, const std::vector<std::string>& known) {
    if (const std::string near = nearest(word, known); !near.empty()) return "; did you mean " + near + "?";
    if (known.empty() || known.size() > 40) return "";
    return "; known: " + enumerate(known);
}

std::string enumerate(const std::vector<std::string>& words, const std::string& separator) {
    std::string all;
    for (const std::string& word : words) all += (all.empty() ? "" : separator) + word;
    return all;
}

}  // namespace talus
