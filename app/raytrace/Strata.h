#pragma once

#include <cstdint>
#include <glm/vec2.hpp>

namespace app {

/// splitmix64's finaliser over everything that tells pixels apart.
inline std::uint64_t strataKey(std::uint64_t seed, std::uint32_t x, std::uint32_t y) {
    std::uint64_t z = seed * 0x9e3779b97f4a7c15ull + (std::uint64_t{x} << 32 | y) + 0x9e3779b97f4a7c15ull;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return z ^ (z >> 31);
}

/// Point `index` of `count` in the unit square: Hammersley's points, shifted round by the key and the
/// dimension, so that neighbouring pixels do not err alike. Every stretch of 1 / count holds one of each
/// coordinate.
inline glm::vec2 stratum(std::uint64_t key, std::uint32_t dimension, int index, int count) {
    const std::uint64_t shift = strataKey(key, dimension, 0x5bd1e995u);
    auto reversed = static_cast<std::uint32_t>(index);
    reversed = (reversed << 16) | (reversed >> 16);
    reversed = ((reversed & 0x00ff00ffu) << 8) | ((reversed & 0xff00ff00u) >> 8);
    reversed = ((reversed & 0x0f0f0f0fu) << 4) | ((reversed & 0xf0f0f0f0u) >> 4);
    reversed = ((reversed & 0x33333333u) << 2) | ((reversed & 0xccccccccu) >> 2);
    reversed = ((reversed & 0x55555555u) << 1) | ((reversed & 0xaaaaaaaau) >> 1);
    reversed += static_cast<std::uint32_t>(shift);  // round the circle
    // A second dimension pairs with another order of the first: or both jitters of a sample would agree.
    const auto order = static_cast<std::uint64_t>(
        dimension == 0
            ? index
            : static_cast<int>((static_cast<std::uint64_t>(index) * 0x9e3779b1ull + (shift >> 40)) %
                               static_cast<std::uint64_t>(count)));
    const double x = (static_cast<double>(order) + static_cast<double>(shift >> 32) * 0x1p-32) /
                     static_cast<double>(count);
    return {static_cast<float>(x), static_cast<float>(static_cast<double>(reversed >> 8) * 0x1p-24)};
}

}  // namespace app
