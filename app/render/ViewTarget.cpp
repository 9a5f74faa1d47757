#include "app/render/ViewTarget.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

namespace app {

namespace gl = reflection::gl;

ViewTarget::ViewTarget(Antialiasing antialiasing)
    : antialiasing_(antialiasing),
      nothing_(gl::VertexArray::create()),
      tiles_(gl::Program::fromFiles({"tiles.vert", "tiles.frag"})),
      rectangles_(gl::Buffer::create()),
      rectangleArray_(gl::VertexArray::create()) {
    rectangleArray_.buffer(0, rectangles_.name(), sizeof(glm::ivec4), 1).integerAttribute(0, 0, 4, GL_INT, 0);
    if (antialiasing_ != Antialiasing::fxaa) return;
    findEdges_ = gl::Program::fromFiles({"fullscreen.vert", "fxaa.frag"}, {"FIND"});
    fxaa_ = gl::Program::fromFiles({"fullscreen.vert", "fxaa.frag"});
}

void ViewTarget::allocate(glm::ivec2 size) {
    if (size_ == size) return;
    size_ = size;
    finished_ = 0;
    dissolve_.stop();
    shown_ = {};
    smooth_ = {};
    if (antialiasing_ == Antialiasing::msaa4) {
        colour_ = gl::Texture::multisampled2D(GL_RGBA8, size.x, size.y, 4);
        depth_ = gl::Texture::multisampled2D(GL_DEPTH_COMPONENT32F, size.x, size.y, 4);
    } else {
        colour_ = gl::Texture::image2D(GL_RGBA8, size.x, size.y);
        colour_.filter(GL_LINEAR, GL_LINEAR).wrap(GL_CLAMP_TO_EDGE);
        depth_ = gl::Texture::image2D(GL_DEPTH_COMPONENT32F, size.x, size.y);
    }
    target_ = gl::Framebuffer::create();
    target_.attach(GL_COLOR_ATTACHMENT0, colour_.name()).attach(GL_DEPTH_ATTACHMENT, depth_.name());
    target_.requireComplete("a view");
    if (antialiasing_ == Antialiasing::fxaa) makeSmooth(true, "antialiasing");
}

void ViewTarget::begin(glm::ivec2 size, double scale) {
    drawn_ = glm::clamp(glm::ivec2(glm::round(glm::dvec2(size) * scale)), glm::ivec2(1), size);
    allocate(size);
    glBindFramebuffer(GL_FRAMEBUFFER, target_.name());
    glViewport(0, 0, drawn_.x, drawn_.y);
    glClearDepth(0);
    glClear(GL_DEPTH_BUFFER_BIT);  // every pixel gets a colour, the sky's at least
}

void ViewTarget::makeSmooth(bool withDepth, const char* purpose) {
    smooth_ = gl::Texture::image2D(GL_RGBA8, size_.x, size_.y);
    smooth_.filter(GL_LINEAR, GL_LINEAR).wrap(GL_CLAMP_TO_EDGE);
    smoothTarget_ = gl::Framebuffer::create();
    smoothTarget_.attach(GL_COLOR_ATTACHMENT0, smooth_.name());
    if (withDepth) smoothTarget_.attach(GL_DEPTH_ATTACHMENT, depth_.name());
    smoothTarget_.requireComplete(purpose);
}

void ViewTarget::mendEdges(int rows) {
    glCopyImageSubData(colour_.name(), GL_TEXTURE_2D, 0, 0, 0, 0, smooth_.name(), GL_TEXTURE_2D, 0, 0, 0, 0,
                       drawn_.x, drawn_.y, 1);
    glBindFramebuffer(GL_FRAMEBUFFER, smoothTarget_.name());
    glDisable(GL_CULL_FACE);
    colour_.bind(3);
    nothing_.bind();
    // Marks take the scene's depth buffer, which has served: depth 1 is the near plane, where nothing is
    // drawn.
    glEnable(GL_SCISSOR_TEST);
    glScissor(0, (drawn_.y - rows) / 2, drawn_.x, rows);
    findEdges_.set("last", drawn_ - 1);
    findEdges_.use();
    glDepthFunc(GL_ALWAYS);
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    fxaa_.set("texel", 1.f / glm::vec2(size_));
    fxaa_.set("last", drawn_ - 1);
    fxaa_.use();
    glDepthFunc(GL_EQUAL);
    glDepthMask(GL_FALSE);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glDepthMask(GL_TRUE);
    glDepthFunc(GL_GEQUAL);
    glDisable(GL_SCISSOR_TEST);
}

void ViewTarget::finish(std::uint32_t framebuffer, double antialiasing) {
    const int rows = static_cast<int>(std::lround(std::clamp(antialiasing, 0.0, 1.0) * drawn_.y));
    const bool mended = antialiasing_ == Antialiasing::fxaa && rows > 0;
    if (mended) mendEdges(rows);
    std::uint32_t source = (mended ? smoothTarget_ : target_).name();
    const bool stretched = drawn_ != size_;
    if ((stretched || dissolve_.active()) && antialiasing_ == Antialiasing::msaa4) {
        // Several samples can neither be stretched nor looked up.
        if (smooth_.name() == 0) makeSmooth(false, "a view that is stretched");
        glBlitNamedFramebuffer(source, smoothTarget_.name(), 0, 0, drawn_.x, drawn_.y, 0, 0, drawn_.x,
                               drawn_.y, GL_COLOR_BUFFER_BIT, GL_NEAREST);
        source = smoothTarget_.name();
    }
    finished_ = source;
    finishedSmooth_ = source != target_.name();
    const gl::Texture& image = finishedSmooth_ ? smooth_ : colour_;
    if (dissolve_.active()) {
        copyParts(image, shownTarget_.name(), dissolve_.advance());
        glBlitNamedFramebuffer(shownTarget_.name(), framebuffer, 0, 0, size_.x, size_.y, 0, 0, size_.x,
                               size_.y, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    } else if (stretched) {
        // Not by a blit, which mixes the border with what lies beyond it.
        const glm::ivec4 all(0, 0, size_);
        copyParts(image, framebuffer, {&all, 1});
    } else {
        glBlitNamedFramebuffer(source, framebuffer, 0, 0, size_.x, size_.y, 0, 0, size_.x, size_.y,
                               GL_COLOR_BUFFER_BIT, GL_NEAREST);
    }
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
}

void ViewTarget::allocateShown() {
    if (shown_.name() != 0) return;
    shown_ = gl::Texture::image2D(GL_RGBA8, size_.x, size_.y);
    shownTarget_ = gl::Framebuffer::create();
    shownTarget_.attach(GL_COLOR_ATTACHMENT0, shown_.name());
    shownTarget_.requireComplete("a view whose detail changes");
}

void ViewTarget::prepareDissolving(glm::ivec2 size) {
    if (size.x <= 0 || size.y <= 0) return;
    // Drivers compile when something is drawn for the first time: a picture of half the size into itself.
    for (const double scale : {1.0, 0.5}) {
        begin(size, scale);
        allocateShown();
        finish(shownTarget_.name());
        dissolve(1);
        begin(size, scale);
        finish(shownTarget_.name());
    }
    finished_ = 0;
}

void ViewTarget::dissolve(int frames) {
    if (finished_ == 0) return;
    allocateShown();
    const glm::ivec4 all(0, 0, size_);
    if (dissolve_.active()) {
        // What is shown is there already.
    } else if (drawn_ != size_) {
        copyParts(finishedSmooth_ ? smooth_ : colour_, shownTarget_.name(), {&all, 1});
    } else {
        glBlitNamedFramebuffer(finished_, shownTarget_.name(), 0, 0, size_.x, size_.y, 0, 0, size_.x, size_.y,
                               GL_COLOR_BUFFER_BIT, GL_NEAREST);
    }
    dissolve_.start(size_, frames);
}

void ViewTarget::copyParts(const gl::Texture& image, std::uint32_t framebuffer,
                           std::span<const glm::ivec4> parts) {
    if (parts.empty()) return;
    rectangles_.replace(parts);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    glViewport(0, 0, size_.x, size_.y);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    image.bind(3);
    tiles_.set("size", glm::vec2(size_));
    tiles_.set("drawn", glm::vec2(drawn_));
    tiles_.use();
    rectangleArray_.bind();
    glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(parts.size()));
    glEnable(GL_DEPTH_TEST);
}

}  // namespace app
