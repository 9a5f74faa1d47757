#pragma once

#include <cstddef>
#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>

#include "reflection/reference_maps/CubeMapping.h"

namespace app {

/// clipFromRelative of cube face 0..5 (+X -X +Y -Y +Z -Z), reversed depth with the far plane at infinity,
/// such that texel (s, t) of the face is where OpenGL's cube sampling looks: table 8.19 of the OpenGL 4.5
/// specification.
inline glm::mat4 clipFromCubeFace(int face, float nearPlane) {
    const reflection::CubeFace& f = reflection::cubeFaces[static_cast<std::size_t>(face)];
    glm::mat4 clip(0);
    for (int i = 0; i < 3; ++i) clip[i] = glm::vec4(f.sAxis[i], f.tAxis[i], 0, f.major[i]);
    clip[3][2] = nearPlane;
    return clip;
}

}  // namespace app
