#pragma once

#include <cstdint>
#include <vector>

#include "reflection/local_map/LocalMap.h"

namespace reflection {

/// A local map ready for upload: all mipmap levels in GL_UNSIGNED_INT_10F_11F_11F_REV (4 bytes a texel),
/// level 0 first, six faces a level. Level k is the 2x2 box filter of level k-1, in linear radiance: what
/// gloss samples.
struct PackedMips {
    int faceSize = 0;
    std::vector<std::uint32_t> texels;
    /// Of level 0, as half floats: 1 / LocalMap::depth, 1/m, 0 for the sky. What parallax samples.
    std::vector<std::uint16_t> nearness;

    int levelCount() const;                    ///< log2(faceSize) + 1
    std::size_t levelOffset(int level) const;  ///< index of the level's first texel
    void resize(int size);                     ///< room for all levels; contents are undefined
};

/// Packs all levels of one face, and its nearness; `out` must have the map's face size. Faces may be packed
/// at the same time.
void packFaceMips(const LocalMap& map, int face, PackedMips& out);

/// Packs a map; a face size that is not a power of two gets level 0 alone. Values are clamped to what 10 and
/// 11 bit floats hold; negative and NaN become 0. Reuses `out`'s memory.
void packMips(const LocalMap& map, PackedMips& out);

/// A half float of packed nearness back to a float (the slow way).
float unpackNearness(std::uint16_t half);

/// One packed texel back to floats (the slow way; oracle and readers).
void unpackTexel(std::uint32_t texel, float& red, float& green, float& blue);

}  // namespace reflection
