#pragma once

#include <array>
#include <cstdint>

#include "reflection/local_map/LocalMapSlot.h"

namespace reflection {

/// GL names that a reflector's shader samples: for each size class a GL_TEXTURE_CUBE_MAP_ARRAY of linear HDR
/// radiance with all mipmaps (gloss chooses the level), 0 where the class is empty.
struct LocalMapTextures {
    std::array<std::uint32_t, localMapFaceSizes.size()> cubeArrays{};
};

}  // namespace reflection
