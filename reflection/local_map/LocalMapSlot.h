#pragma once

#include <array>
#include <cstdint>

namespace reflection {

/// Face sizes of local maps, finest first. A reflector's map lives in one layer of the cube map array of its
/// class.
inline constexpr std::array<int, 5> localMapFaceSizes{128, 64, 32, 16, 8};

/// Where a reflector finds its environment.
struct LocalMapSlot {
    std::int16_t sizeClass = -1;  ///< index into localMapFaceSizes; -1: no map, plain paint
    std::int16_t layer = 0;       ///< cube index within the class's array
    bool valid() const { return sizeClass >= 0; }
};

}  // namespace reflection
