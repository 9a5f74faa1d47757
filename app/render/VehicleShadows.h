#pragma once

#include <array>
#include <glm/vec4.hpp>
#include <span>
#include <vector>

#include "app/render/PassTarget.h"
#include "app/render/VehicleGeometry.h"
#include "reflection/gl/Buffer.h"
#include "reflection/gl/Program.h"
#include "reflection/gl/VertexArray.h"
#include "vehicles/traffic/VehiclePose.h"

namespace app {

/// Shadows of vehicles on the road: one blended rectangle each, in which the shadow of two boxes (body and
/// cabin) and the dark under the floor are worked out per pixel. No second shadow map: nothing else in the
/// frame pays for them.
class VehicleShadows {
  public:
    VehicleShadows();
    /// After the city and the vehicles, before the sky. Vehicles below `smallest` pixels are left out.
    /// Returns the number of draw calls.
    /// `target`: display values, or (cube) linear radiance.
    std::uint32_t draw(const PassView& view, const VehicleGeometry& geometry,
                       std::span<const vehicles::VehiclePose> poses, std::span<const std::uint32_t> chosen,
                       float smallest = 8, PassTarget target = PassTarget::view);

  private:
    struct Instance {
        glm::vec4 place;
        glm::vec4 outline;
    };
    std::array<reflection::gl::Program, 2> programs_;  ///< [target]
    reflection::gl::Buffer buffer_;
    reflection::gl::VertexArray array_;
    std::vector<Instance> instances_;
};

}  // namespace app
