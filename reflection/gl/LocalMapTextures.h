#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

#include "reflection/local_map/LocalMapSlot.h"

namespace reflection {

/// What a reflector's shader samples. The spans are good until the atlas next changes.
struct LocalMapTextures {
    /// GL names, for each size class a GL_TEXTURE_CUBE_MAP_ARRAY of linear HDR radiance with all mipmaps
    /// (gloss chooses the level), 0 where the class is empty.
    std::array<std::uint32_t, localMapFaceSizes.size()> cubeArrays{};
    /// For parallax, GL_R16F of the same faces, level 0 alone: 1 / distance along the texel's cube direction
    /// (greatest component 1), 1/m, 0 for the sky. All 0: the reflected direction alone counts.
    std::array<std::uint32_t, localMapFaceSizes.size()> nearnessArrays{};
    std::array<std::span<const glm::dvec3>, localMapFaceSizes.size()> centres{};  ///< of the layers, world
};

}  // namespace reflection
