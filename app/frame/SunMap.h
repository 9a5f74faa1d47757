#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <vector>

namespace app {

/// The rasteriser's shadow map in memory: how far the sun's light comes, seen along its direction.
struct SunMap {
    glm::mat4 shadowFromWorld{
        1};                  ///< world to texture coordinates (xy, 0..1) and depth (z, 1 nearest the sun)
    float normalOffset = 0;  ///< metres by which receivers are moved along their normal
    int size = 0;            ///< texels a side
    std::vector<std::uint16_t> depth;  ///< size * size, row 0 at texture coordinate 0

    /// Share of the sun's light at a shadow coordinate: GL_LINEAR over comparisons GL_GEQUAL, nothing in the
    /// way outside the map.
    float lightAt(const glm::vec3& coordinate) const;
};

}  // namespace app
