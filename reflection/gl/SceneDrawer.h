#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

namespace reflection {

/// What a cube view shows.
struct CubeContent {
    bool city = true;                             ///< the static world; false: sky alone
    bool vehicles = false;                        ///< moving vehicles
    std::uint32_t excludedVehicle = 0xffffffffu;  ///< id of the vehicle from whose centre the cube is seen
};

/// A cube target: one layer of two cube map arrays that the caller owns.
struct CubeTarget {
    std::uint32_t colour = 0;  ///< GL name, GL_TEXTURE_CUBE_MAP_ARRAY, a float colour format: linear radiance
    std::uint32_t distance = 0;  ///< GL name of a GL_R32F cube map array of the same size, or 0: not wanted
    int layer = 0;               ///< cube index
    int faceSize = 128;          ///< texels
};

/// How the reflection methods see the caller's scene: the one thing a host engine implements. A GL 4.5
/// context is current in every call; the implementation may change any GL state.
class SceneDrawer {
  public:
    virtual ~SceneDrawer() = default;

    /// Draws six faces (+X -X +Y -Y +Z -Z along world axes, OpenGL cube orientation: face (s, t) as GL
    /// samples it) around a centre in world metres. Colour is linear HDR radiance, not tone mapped; distance
    /// is metres from the centre, +infinity for sky.
    virtual void drawCube(const glm::dvec3& centre, const CubeTarget& target, const CubeContent& content) = 0;
};

}  // namespace reflection
