#pragma once

#include <epoxy/gl.h>

#include <cstddef>
#include <span>

#include "reflection/gl/Handle.h"

namespace reflection::gl {

inline void destroyBuffer(std::uint32_t name) {
    glDeleteBuffers(1, &name);
}

/// A GL buffer object.
class Buffer {
  public:
    /// A name without storage; fill it with `replace`.
    static Buffer create() {
        Buffer buffer;
        GLuint name = 0;
        glCreateBuffers(1, &name);
        buffer.handle_ = Handle<destroyBuffer>(name);
        return buffer;
    }

    /// Immutable contents. An empty span gives a buffer of one byte, so that it can always be bound.
    template <class T>
    static Buffer filled(std::span<const T> data) {
        Buffer buffer = create();
        if (data.empty()) {
            glNamedBufferStorage(buffer.name(), 1, nullptr, 0);
        } else {
            glNamedBufferStorage(buffer.name(), static_cast<GLsizeiptr>(data.size_bytes()), data.data(), 0);
        }
        return buffer;
    }

    /// Immutable storage that the GPU alone fills (by copies, by shaders); contents are undefined.
    static Buffer sized(std::size_t bytes) {
        Buffer buffer = create();
        glNamedBufferStorage(buffer.name(), static_cast<GLsizeiptr>(bytes), nullptr, 0);
        return buffer;
    }

    /// New contents in new storage: what the GPU still reads stays untouched, so this never waits.
    template <class T>
    void replace(std::span<const T> data, GLenum usage = GL_STREAM_DRAW) {
        glNamedBufferData(name(), static_cast<GLsizeiptr>(data.size_bytes()),
                          data.empty() ? nullptr : data.data(), usage);
    }
    template <class T>
    void replaceWith(const T& value, GLenum usage = GL_STREAM_DRAW) {
        replace(std::span<const T>(&value, 1), usage);
    }

    GLuint name() const { return handle_.name(); }
    explicit operator bool() const { return static_cast<bool>(handle_); }

  private:
    Handle<destroyBuffer> handle_;
};

}  // namespace reflection::gl
