#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "app/frame/FrameScene.h"
#include "app/raytrace/RayMeshes.h"
#include "app/raytrace/RayShading.h"

namespace app {

/// The shadows of vehicles on the ground as the rasteriser blends them over a view: twin of VehicleShadows
/// with vehicle_shadow.vert and .frag.
class GroundShadows {
  public:
    GroundShadows(const FrameScene& frame, const RayMeshes& meshes, const RayShading& shading,
                  const View& view);
    /// Those of all vehicles, for rays from anywhere.
    GroundShadows(const FrameScene& frame, const RayMeshes& meshes, const RayShading& shading);

    /// Factor on display colours of what lies `distance` metres away in a direction (unit) from the eye.
    glm::vec3 factor(const glm::vec3& direction, float distance) const;
    /// Factor on the radiance of what a ray meets after `distance` metres, as passes that draw radiance have
    /// it. Of shadows that are not a view's alone.
    glm::vec3 share(const glm::vec3& origin, const glm::vec3& direction, float distance) const;

  private:
    struct Rectangle {
        std::array<glm::vec3, 4> corner;  ///< relative to the eye, pulled towards it
        std::array<glm::vec2, 4> position;
        std::array<glm::vec3, 4> world;
        glm::vec3 middle{0};
        float radius = 0;
        glm::vec2 halfSize{0};
        float height = 0;
        glm::vec3 towardsSun{0};
    };
    /// Around `eye`; corners where they lie, not pulled.
    static Rectangle rectangleOf(const vehicles::VehiclePose& pose, const VehicleLevels& model,
                                 const glm::dvec3& eye, const glm::vec3& sun);
    static void bound(Rectangle& rectangle);
    /// Over the shadows that a ray meets; `before`: whether one at that distance counts.
    glm::vec3 product(const glm::vec3& origin, const glm::vec3& direction,
                      const std::function<bool(float)>& before) const;
    glm::vec3 shareAt(const Rectangle& rectangle, const glm::vec2& position, const glm::vec3& world) const;

    const RayShading* shading_;
    std::vector<Rectangle> rectangles_;
};

}  // namespace app
