#pragma once

#include <epoxy/gl.h>

#include <stdexcept>
#include <string>

#include "reflection/gl/Handle.h"

namespace reflection::gl {

inline void destroyFramebuffer(std::uint32_t name) {
    glDeleteFramebuffers(1, &name);
}

/// A GL framebuffer object: attachments are set by GL name, which the caller keeps alive.
class Framebuffer {
  public:
    Framebuffer() = default;
    static Framebuffer create() {
        GLuint name = 0;
        glCreateFramebuffers(1, &name);
        Framebuffer f;
        f.handle_ = Handle<destroyFramebuffer>(name);
        return f;
    }
    Framebuffer& attach(GLenum attachment, GLuint texture, int level = 0) {
        glNamedFramebufferTexture(name(), attachment, texture, level);
        return *this;
    }
    Framebuffer& attachLayer(GLenum attachment, GLuint texture, int layer, int level = 0) {
        glNamedFramebufferTextureLayer(name(), attachment, texture, level, layer);
        return *this;
    }
    /// Throws std::runtime_error, naming `purpose`, unless the framebuffer can be drawn to.
    void requireComplete(const char* purpose) const {
        const GLenum status = glCheckNamedFramebufferStatus(name(), GL_DRAW_FRAMEBUFFER);
        if (status != GL_FRAMEBUFFER_COMPLETE) {
            throw std::runtime_error(std::string("OpenGL cannot draw into the framebuffer for ") + purpose +
                                     " (status " + std::to_string(status) +
                                     "): its formats are not supported by this driver; update the driver.");
        }
    }
    GLuint name() const { return handle_.name(); }
    explicit operator bool() const { return static_cast<bool>(handle_); }

  private:
    Handle<destroyFramebuffer> handle_;
};

}  // namespace reflection::gl
