#include "app/render/VehicleShadows.h"

#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>

#include "app/frame/StandingReflectors.h"

namespace app {

namespace gl = reflection::gl;

VehicleShadows::VehicleShadows()
    : programs_{gl::Program::fromFiles({"vehicle_shadow.vert", "vehicle_shadow.frag"}),
                gl::Program::fromFiles({"vehicle_shadow.vert", "vehicle_shadow.frag"}, {"LINEAR"})},
      buffer_(gl::Buffer::create()),
      array_(gl::VertexArray::create()) {
    array_.buffer(0, buffer_.name(), sizeof(Instance), 1)
        .attribute(0, 0, 4, GL_FLOAT, false, offsetof(Instance, place))
        .attribute(1, 0, 4, GL_FLOAT, false, offsetof(Instance, outline));
}

std::uint32_t VehicleShadows::draw(const PassView& view, const VehicleGeometry& geometry,
                                   std::span<const vehicles::VehiclePose> poses,
                                   std::span<const std::uint32_t> chosen, float smallest, PassTarget target) {
    instances_.clear();
    for (std::uint32_t index : chosen) {
        const vehicles::VehiclePose& pose = poses[index];
        if (stands(pose)) continue;  // its shadow is the sun's, with the city's
        const VehicleGeometry::Model& model = geometry.models()[pose.model];
        const glm::vec3 position(pose.position - view.eye);
        if (view.allowedError(smallest, glm::length(position)) > 2 * model.radius) continue;
        const auto c = static_cast<float>(std::cos(pose.heading));
        const auto s = static_cast<float>(std::sin(pose.heading));
        const glm::vec3 middle = position + glm::vec3(c * model.centre.x - s * model.centre.y,
                                                      s * model.centre.x + c * model.centre.y, 0);
        instances_.push_back({glm::vec4(middle, c), glm::vec4(s, model.halfSize.x, model.halfSize.y,
                                                              model.centre.z + model.halfSize.z)});
    }
    if (instances_.empty()) return 0;
    buffer_.replace(std::span<const Instance>(instances_));
    glEnable(GL_BLEND);
    glBlendFunc(GL_DST_COLOR, GL_ZERO);
    glDepthMask(GL_FALSE);
    glDisable(GL_CULL_FACE);
    const bool linear = target == PassTarget::cube;
    programs_[linear ? 1 : 0].use();
    if (linear) glColorMaski(1, GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);  // distances stay
    array_.bind();
    glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(instances_.size()));
    if (linear) glColorMaski(1, GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glDepthMask(GL_TRUE);
    glDisable(GL_BLEND);
    return 1;
}

}  // namespace app
