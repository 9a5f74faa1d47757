#include "app/render/SignalLamps.h"

#include <algorithm>
#include <cstddef>
#include <glm/geometric.hpp>

#include "app/frame/SignalLamp.h"

namespace app {

namespace gl = reflection::gl;

SignalLamps::SignalLamps(std::vector<city::SignalHead> heads)
    : heads_(std::move(heads)), buffer_(gl::Buffer::create()), array_(gl::VertexArray::create()) {
    for (std::size_t target = 0; target < 2; ++target)
        programs_[target] =
            gl::Program::fromFiles({"lamp.vert", "lamp.frag"}, definesFor(static_cast<PassTarget>(target)));
    array_.buffer(0, buffer_.name(), sizeof(Instance), 1)
        .attribute(0, 0, 4, GL_FLOAT, false, offsetof(Instance, place))
        .attribute(1, 0, 4, GL_FLOAT, false, offsetof(Instance, facing))
        .attribute(2, 0, 4, GL_FLOAT, false, offsetof(Instance, colour));
}

std::uint32_t SignalLamps::draw(const PassView& view, PassTarget target,
                                std::span<const vehicles::SignalColour> colours) {
    instances_.clear();
    for (std::size_t i = 0; i < std::min(heads_.size(), colours.size()); ++i) {
        const city::SignalHead& head = heads_[i];
        const SignalLamp lamp = litLamp(head, colours[i]);
        const glm::vec3 position(glm::dvec3(lamp.centre) - view.eye);
        if (glm::dot(position, head.facing) > 0) continue;  // seen from behind
        if (view.allowedError(0.5f, glm::length(position)) > 2 * SignalLamp::radius) continue;
        if (!view.frustum.touches(position, SignalLamp::radius)) continue;
        instances_.push_back({glm::vec4(position, SignalLamp::radius), glm::vec4(head.facing, 0),
                              glm::vec4(lamp.radiance, 0)});
    }
    if (instances_.empty()) return 0;
    buffer_.replace(std::span<const Instance>(instances_));
    glDisable(GL_CULL_FACE);
    programs_[static_cast<std::size_t>(target)].use();
    array_.bind();
    glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(instances_.size()));
    return 1;
}

}  // namespace app
