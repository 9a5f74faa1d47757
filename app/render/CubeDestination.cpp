#include "app/render/CubeDestination.h"

#include <epoxy/gl.h>

#include <array>

namespace app {

namespace gl = reflection::gl;

namespace {

/// Six layers of the caller's cube array by themselves, so that clearing and drawing touch no other cube.
/// Made anew for each cube: the caller may have deleted its texture and got the same name for another.
gl::Texture facesOf(std::uint32_t texture, int cube) {
    GLint format = 0;
    glGetTextureLevelParameteriv(texture, 0, GL_TEXTURE_INTERNAL_FORMAT, &format);
    return gl::Texture::view(GL_TEXTURE_2D_ARRAY, texture, static_cast<GLenum>(format), 0, 1, 6 * cube, 6);
}

}  // namespace

CubeDestination::CubeDestination()
    : layered_(epoxy_has_gl_extension("GL_ARB_shader_viewport_layer_array")),
      framebuffer_(gl::Framebuffer::create()) {}

void CubeDestination::requireDepth(int faceSize) {
    if (depthSize_ == faceSize) return;
    depthSize_ = faceSize;
    depth_ = gl::Texture::array2D(GL_DEPTH_COMPONENT32F, faceSize, faceSize, 6);
}

void CubeDestination::begin(const reflection::CubeTarget& target) {
    target_ = target;
    requireDepth(target.faceSize);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
    glViewport(0, 0, target.faceSize, target.faceSize);
    const std::array<GLenum, 2> attachments{GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
    glNamedFramebufferDrawBuffers(framebuffer_.name(), target.distance != 0 ? 2 : 1, attachments.data());
    if (target.distance == 0) framebuffer_.attach(GL_COLOR_ATTACHMENT1, 0);
    glClearDepth(0);
    if (!layered_) return;
    colourView_ = facesOf(target.colour, target.layer);
    framebuffer_.attach(GL_COLOR_ATTACHMENT0, colourView_.name());
    if (target.distance != 0) {
        distanceView_ = facesOf(target.distance, target.layer);
        framebuffer_.attach(GL_COLOR_ATTACHMENT1, distanceView_.name());
    }
    framebuffer_.attach(GL_DEPTH_ATTACHMENT, depth_.name());
    glClear(GL_DEPTH_BUFFER_BIT);
}

void CubeDestination::selectFace(int face) {
    if (layered_) return;
    framebuffer_.attachLayer(GL_COLOR_ATTACHMENT0, target_.colour, 6 * target_.layer + face);
    if (target_.distance != 0)
        framebuffer_.attachLayer(GL_COLOR_ATTACHMENT1, target_.distance, 6 * target_.layer + face);
    framebuffer_.attachLayer(GL_DEPTH_ATTACHMENT, depth_.name(), face);
    glClear(GL_DEPTH_BUFFER_BIT);
}

}  // namespace app
