#pragma once

#include <array>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

namespace app {

/// clipFromRelative of cube face 0..5 (+X -X +Y -Y +Z -Z), reversed depth with the far plane at infinity,
/// such that texel (s, t) of the face is where OpenGL's cube sampling looks: table 8.19 of the OpenGL 4.5
/// specification.
inline glm::mat4 clipFromCubeFace(int face, float nearPlane) {
    struct Axes {
        glm::vec3 s, t, major;
    };
    static constexpr std::array<Axes, 6> axes{{{{0, 0, -1}, {0, -1, 0}, {1, 0, 0}},
                                               {{0, 0, 1}, {0, -1, 0}, {-1, 0, 0}},
                                               {{1, 0, 0}, {0, 0, 1}, {0, 1, 0}},
                                               {{1, 0, 0}, {0, 0, -1}, {0, -1, 0}},
                                               {{1, 0, 0}, {0, -1, 0}, {0, 0, 1}},
                                               {{-1, 0, 0}, {0, -1, 0}, {0, 0, -1}}}};
    const Axes& a = axes[static_cast<std::size_t>(face)];
    glm::mat4 clip(0);
    for (int i = 0; i < 3; ++i) clip[i] = glm::vec4(a.s[i], a.t[i], 0, a.major[i]);
    clip[3][2] = nearPlane;
    return clip;
}

}  // namespace app
