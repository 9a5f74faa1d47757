#pragma once

#include <glm/common.hpp>
#include <glm/vec2.hpp>

#include "reflection/gl/Framebuffer.h"
#include "reflection/gl/Texture.h"

namespace reflection::gl {

/// The map of one recursion level: colour, depth, and distance where a rough mirror asks for it. Sizes are
/// multiples of 64, so that six halvings of a part of it end on whole texels; it grows as asked and never
/// shrinks by itself.
class MirrorLevel {
  public:
    /// Makes room for `needed` texels.
    void require(const glm::ivec2& needed, GLenum format, bool withDistance) {
        const glm::ivec2 rounded = (glm::max(needed, glm::ivec2(1)) + 63) / 64 * 64;
        if (colour && size_.x >= rounded.x && size_.y >= rounded.y && (withDistance_ || !withDistance))
            return;
        size_ = glm::max(size_, rounded);
        withDistance_ = withDistance_ || withDistance;
        colour = Texture::image2D(format, size_.x, size_.y);
        colour.filter(GL_LINEAR, GL_LINEAR).wrap(GL_CLAMP_TO_EDGE);
        depth = Texture::image2D(GL_DEPTH_COMPONENT32F, size_.x, size_.y);
        framebuffer = Framebuffer::create();
        framebuffer.attach(GL_COLOR_ATTACHMENT0, colour.name()).attach(GL_DEPTH_ATTACHMENT, depth.name());
        if (withDistance_) {
            distance = Texture::image2D(GL_R32F, size_.x, size_.y);
            distance.filter(GL_NEAREST, GL_NEAREST).wrap(GL_CLAMP_TO_EDGE);
            framebuffer.attach(GL_COLOR_ATTACHMENT1, distance.name());
            const GLenum both[2] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
            glNamedFramebufferDrawBuffers(framebuffer.name(), 2, both);
        }
        framebuffer.requireComplete("a mirror's map");
        if (!withDistance_) return;
        colourAlone = Framebuffer::create();
        colourAlone.attach(GL_COLOR_ATTACHMENT0, colour.name()).attach(GL_DEPTH_ATTACHMENT, depth.name());
        colourAlone.requireComplete("a mirror's map");
    }
    const glm::ivec2& size() const { return size_; }
    bool withDistance() const { return withDistance_; }
    /// To draw into: writing distance that nobody reads takes time.
    const Framebuffer& target(bool distanceWanted) const {
        return withDistance_ && !distanceWanted ? colourAlone : framebuffer;
    }
    std::uint64_t texels() const {
        return static_cast<std::uint64_t>(size_.x) * static_cast<std::uint64_t>(size_.y);
    }

    Texture colour, depth, distance;
    Framebuffer framebuffer, colourAlone;  ///< with all there is; without distance, where there is some

  private:
    glm::ivec2 size_{0};
    bool withDistance_ = false;
};

}  // namespace reflection::gl
