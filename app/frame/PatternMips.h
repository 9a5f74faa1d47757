#pragma once

#include <cstdint>
#include <vector>

namespace app {

/// The pictures of all patterns as they are drawn: RGBA, 8 bit, one size, with mipmaps. Colours are square
/// roots of albedos: almost as even to the eye as sRGB, but decoded with one multiplication, and plain 8 bit
/// textures take the fastest path of a software rasteriser.
struct PatternMips {
    int size = 1;  ///< texels, square, a power of two
    /// [pattern][level]: level l has (size >> l)^2 texels, row 0 at texture coordinate v = 0.
    std::vector<std::vector<std::vector<std::uint8_t>>> texels;

    int levels() const;  ///< down to one texel
};

/// Cost: some 0.1 s, on all processors.
PatternMips patternMips();

}  // namespace app
