#pragma once

#include <array>
#include <cmath>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace reflection {

/// One face of a cube map in OpenGL's order and orientation (+X -X +Y -Y +Z -Z, OpenGL 4.5 core, table 8.19):
/// the point (s, t) in [-1, 1]^2 of the face lies in direction major + s * sAxis + t * tAxis. The direction
/// is linear in s and t, and its component along the major axis is 1 in size: that is what makes 1 / (ray
/// parameter) of a plane linear over a face.
struct CubeFace {
    glm::vec3 major;
    glm::vec3 sAxis;
    glm::vec3 tAxis;
};

inline constexpr std::array<CubeFace, 6> cubeFaces{{
    {{1, 0, 0}, {0, 0, -1}, {0, -1, 0}},
    {{-1, 0, 0}, {0, 0, 1}, {0, -1, 0}},
    {{0, 1, 0}, {1, 0, 0}, {0, 0, 1}},
    {{0, -1, 0}, {1, 0, 0}, {0, 0, -1}},
    {{0, 0, 1}, {1, 0, 0}, {0, -1, 0}},
    {{0, 0, -1}, {-1, 0, 0}, {0, -1, 0}},
}};

/// Direction through a point of a face given in texels (0 .. faceSize from edge to edge; texel centres at
/// .5).
inline glm::vec3 cubeDirection(int face, glm::vec2 texel, int faceSize) {
    const CubeFace& f = cubeFaces[static_cast<std::size_t>(face)];
    const glm::vec2 st = texel * (2.0f / static_cast<float>(faceSize)) - 1.0f;
    return f.major + st.x * f.sAxis + st.y * f.tAxis;
}

struct CubePoint {
    int face;
    glm::vec2 st;  ///< -1 .. 1
};

/// Where a direction meets the cube. On an edge or corner the first of x, y, z with the greatest size
/// decides. The zero vector and NaN give face 0 with whatever st follows.
inline CubePoint cubePoint(const glm::vec3& d) {
    const float ax = std::abs(d.x), ay = std::abs(d.y), az = std::abs(d.z);
    int face;
    float major;
    if (ax >= ay && ax >= az) {
        face = d.x < 0 ? 1 : 0;
        major = ax;
    } else if (ay >= az) {
        face = d.y < 0 ? 3 : 2;
        major = ay;
    } else {
        face = d.z < 0 ? 5 : 4;
        major = az;
    }
    const CubeFace& f = cubeFaces[static_cast<std::size_t>(face)];
    const float s = f.sAxis.x * d.x + f.sAxis.y * d.y + f.sAxis.z * d.z;
    const float t = f.tAxis.x * d.x + f.tAxis.y * d.y + f.tAxis.z * d.z;
    return {face, glm::vec2(s / major, t / major)};
}

/// Solid angle of a texel whose centre has these face coordinates, in steradians (exact in the limit of small
/// texels).
inline float texelSolidAngle(glm::vec2 st, int faceSize) {
    const float side = 2.0f / static_cast<float>(faceSize);
    const float r2 = 1 + st.x * st.x + st.y * st.y;
    return side * side / (r2 * std::sqrt(r2));
}

}  // namespace reflection
