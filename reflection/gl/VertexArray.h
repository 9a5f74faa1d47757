#pragma once

#include <epoxy/gl.h>

#include "reflection/gl/Handle.h"

namespace reflection::gl {

inline void destroyVertexArray(std::uint32_t name) {
    glDeleteVertexArrays(1, &name);
}

/// A GL vertex array object: which buffers feed which shader inputs.
class VertexArray {
  public:
    VertexArray() = default;
    static VertexArray create() {
        GLuint name = 0;
        glCreateVertexArrays(1, &name);
        VertexArray v;
        v.handle_ = Handle<destroyVertexArray>(name);
        return v;
    }
    /// Vertex buffer `buffer` at binding point `binding`; divisor 1: one element an instance.
    VertexArray& buffer(GLuint binding, GLuint buffer, GLsizei stride, GLuint divisor = 0) {
        glVertexArrayVertexBuffer(name(), binding, buffer, 0, stride);
        glVertexArrayBindingDivisor(name(), binding, divisor);
        return *this;
    }
    VertexArray& attribute(GLuint location, GLuint binding, GLint count, GLenum type, bool normalised,
                           GLuint offset) {
        glEnableVertexArrayAttrib(name(), location);
        glVertexArrayAttribFormat(name(), location, count, type, normalised ? GL_TRUE : GL_FALSE, offset);
        glVertexArrayAttribBinding(name(), location, binding);
        return *this;
    }
    VertexArray& integerAttribute(GLuint location, GLuint binding, GLint count, GLenum type, GLuint offset) {
        glEnableVertexArrayAttrib(name(), location);
        glVertexArrayAttribIFormat(name(), location, count, type, offset);
        glVertexArrayAttribBinding(name(), location, binding);
        return *this;
    }
    VertexArray& indices(GLuint buffer) {
        glVertexArrayElementBuffer(name(), buffer);
        return *this;
    }
    void bind() const { glBindVertexArray(name()); }
    GLuint name() const { return handle_.name(); }

  private:
    Handle<destroyVertexArray> handle_;
};

}  // namespace reflection::gl
