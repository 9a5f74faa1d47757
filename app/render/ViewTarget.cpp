#include "app/render/ViewTarget.h"

#include <epoxy/gl.h>

namespace app {

namespace gl = reflection::gl;

ViewTarget::ViewTarget(Antialiasing antialiasing)
    : antialiasing_(antialiasing), nothing_(gl::VertexArray::create()) {
    if (antialiasing_ == Antialiasing::fxaa) fxaa_ = gl::Program::fromFiles({"fullscreen.vert", "fxaa.frag"});
}

void ViewTarget::begin(glm::ivec2 size) {
    if (size_ != size) {
        size_ = size;
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
    }
    glBindFramebuffer(GL_FRAMEBUFFER, target_.name());
    glViewport(0, 0, size.x, size.y);
    glClearDepth(0);
    glClear(GL_DEPTH_BUFFER_BIT);  // every pixel gets a colour, the sky's at least
}

void ViewTarget::finish(std::uint32_t framebuffer) {
    glBlitNamedFramebuffer(target_.name(), framebuffer, 0, 0, size_.x, size_.y, 0, 0, size_.x, size_.y,
                           GL_COLOR_BUFFER_BIT, GL_NEAREST);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    if (antialiasing_ != Antialiasing::fxaa) return;
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    colour_.bind(3);
    fxaa_.set("texel", 1.f / glm::vec2(size_));
    fxaa_.set("last", size_ - 1);
    fxaa_.use();
    nothing_.bind();
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glEnable(GL_DEPTH_TEST);
}

}  // namespace app
