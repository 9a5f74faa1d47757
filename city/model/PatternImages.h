#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "city/model/Material.h"

namespace city {

/// Tileable sRGB-encoded RGBA picture of one pattern; alpha is opacity (cut-outs) and 255 elsewhere.
struct PatternImage {
    int size = 256;                  ///< texels, square, a power of two
    std::vector<std::uint8_t> rgba;  ///< size * size * 4, row 0 at texture coordinate v = 0
};

/// The picture of every Pattern, painted by program from a fixed seed: the same on every machine. Mean albedo
/// stays near 1 for patterns that are meant to be tinted.
std::array<PatternImage, static_cast<std::size_t>(Pattern::count)> paintPatterns();

}  // namespace city
