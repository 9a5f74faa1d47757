#include "app/render/SignalLamps.h"

#include <algorithm>
#include <cstddef>
#include <glm/geometric.hpp>

namespace app {

namespace gl = reflection::gl;

namespace {

constexpr float lampRadius = 0.1f;    // metres: lenses of 200 mm
constexpr float lampSpacing = 0.27f;  // metres between lamp centres
constexpr float lampAhead = 0.16f;    // metres in front of the head's middle: before its housing

}  // namespace

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
        const bool red = colours[i] == vehicles::SignalColour::red;
        const bool amber = colours[i] == vehicles::SignalColour::amber;
        const glm::vec3 up(0, 0, red ? lampSpacing : amber ? 0.f : -lampSpacing);
        const glm::vec3 position(glm::dvec3(head.position + up + lampAhead * head.facing) - view.eye);
        if (glm::dot(position, head.facing) > 0) continue;  // seen from behind
        if (view.allowedError(0.5f, glm::length(position)) > 2 * lampRadius) continue;
        if (!view.frustum.touches(position, lampRadius)) continue;
        const glm::vec3 colour = red     ? glm::vec3(5, 0.25f, 0.1f)
                                 : amber ? glm::vec3(4.5f, 2, 0.1f)
                                         : glm::vec3(0.2f, 3.6f, 1.6f);
        instances_.push_back(
            {glm::vec4(position, lampRadius), glm::vec4(head.facing, 0), glm::vec4(colour, 0)});
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
