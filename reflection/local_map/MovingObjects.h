#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "reflection/local_map/LocalMap.h"

namespace reflection {

/// A moving object as a local map sees it: lit triangles around the map's centre. Front faces are
/// counter-clockwise.
struct MovingObject {
    std::vector<glm::vec3> positions;    ///< relative to the map's centre, world axes, metres
    std::vector<glm::vec3> radiance;     ///< linear RGB towards the centre, one per position
    std::vector<std::uint32_t> indices;  ///< three a triangle
};

/// Draws objects over the static scene of one face of a local map, nearer over farther (what the paper left
/// undone for vehicles, section 6). Triangles are clipped to the face; a texel belongs to a triangle when its
/// centre does (top-left rule, so that shared edges are drawn once). Radiance is interpolated in perspective.
/// Returns the texels written.
std::uint32_t drawMovingObjects(std::span<const MovingObject> objects, int face, LocalMap& map);

}  // namespace reflection
