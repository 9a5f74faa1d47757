#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "reflection/chrome/VirtualVertex.h"
#include "reflection/planar/EyeView.h"

namespace reflection {

/// The pixels that virtual meshes are drawn into, one sample in the middle of each.
struct VirtualWindow {
    glm::mat4 clipFromVirtual{1};
    glm::ivec2 size{0};     ///< of the picture
    PixelRect pixels = {};  ///< of those, what is drawn
};

/// The triangles whose surrounding rectangle holds the middle of a pixel that is drawn; the others draw
/// nothing: in a reflection most are smaller than a pixel. What reaches behind the eye is kept. Cost: some
/// nanoseconds a triangle, a tenth of what a software rasteriser takes to set it up.
void showing(std::span<const VirtualVertex> vertices, std::span<const std::uint32_t> triangles,
             const VirtualWindow& window, std::vector<std::uint32_t>& out);

}  // namespace reflection
