// FNV-1a, 64 bits, byte by byte [Fowler, Noll & Vo]: a number that tells two texts or two states apart.
#pragma once

#include <cstdint>
#include <string_view>

namespace talus {

struct Fnv1a {
    std::uint64_t value = 0xcbf29ce484222325ULL;

    void add(std::uint8_t byte) { value = (value ^ byte) * 0x100000001b3ULL; }
};

inline std::uint64_t fnv1a(std::string_view text) {
    Fnv1a hash;
    for (const char c : text) hash.add(static_cast<std::uint8_t>(c));
    return hash.value;
}

}  // namespace talus
