#pragma once

#include <epoxy/gl.h>

#include "reflection/gl/Handle.h"

namespace reflection::gl {

inline void destroyTexture(std::uint32_t name) {
    glDeleteTextures(1, &name);
}
inline void destroySampler(std::uint32_t name) {
    glDeleteSamplers(1, &name);
}

/// Number of levels down to one texel. Precondition: size >= 1.
inline int mipLevels(int size) {
    int levels = 1;
    while ((size >>= 1) > 0) ++levels;
    return levels;
}

/// A GL texture with immutable storage.
class Texture {
  public:
    static Texture image2D(GLenum format, int width, int height, int levels = 1) {
        Texture t(GL_TEXTURE_2D);
        glTextureStorage2D(t.name(), levels, format, width, height);
        return t;
    }
    static Texture multisampled2D(GLenum format, int width, int height, int samples) {
        Texture t(GL_TEXTURE_2D_MULTISAMPLE);
        glTextureStorage2DMultisample(t.name(), samples, format, width, height, GL_TRUE);
        return t;
    }
    static Texture array2D(GLenum format, int width, int height, int layers, int levels = 1) {
        Texture t(GL_TEXTURE_2D_ARRAY);
        glTextureStorage3D(t.name(), levels, format, width, height, layers);
        return t;
    }
    static Texture cube(GLenum format, int faceSize, int levels = 1) {
        Texture t(GL_TEXTURE_CUBE_MAP);
        glTextureStorage2D(t.name(), levels, format, faceSize, faceSize);
        return t;
    }
    static Texture cubeArray(GLenum format, int faceSize, int cubes, int levels = 1) {
        Texture t(GL_TEXTURE_CUBE_MAP_ARRAY);
        glTextureStorage3D(t.name(), levels, format, faceSize, faceSize, 6 * cubes);
        return t;
    }
    /// A buffer's contents as texels, as many as the implementation allows.
    static Texture buffer(GLenum format, GLuint buffer) {
        Texture t(GL_TEXTURE_BUFFER);
        glTextureBuffer(t.name(), format, buffer);
        return t;
    }
    /// Other eyes on the storage of `original`: a range of its layers as a texture of another target.
    static Texture view(GLenum target, GLuint original, GLenum format, int firstLevel, int levels,
                        int firstLayer, int layers) {
        GLuint name = 0;
        glGenTextures(1, &name);
        Texture t;
        t.target_ = target;
        t.handle_ = Handle<destroyTexture>(name);
        glTextureView(name, target, original, format, static_cast<GLuint>(firstLevel),
                      static_cast<GLuint>(levels), static_cast<GLuint>(firstLayer),
                      static_cast<GLuint>(layers));
        return t;
    }

    Texture() = default;

    Texture& filter(GLenum minify, GLenum magnify) {
        glTextureParameteri(name(), GL_TEXTURE_MIN_FILTER, static_cast<GLint>(minify));
        glTextureParameteri(name(), GL_TEXTURE_MAG_FILTER, static_cast<GLint>(magnify));
        return *this;
    }
    Texture& wrap(GLenum mode) {
        for (GLenum axis : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
            glTextureParameteri(name(), axis, static_cast<GLint>(mode));
        return *this;
    }
    void bind(GLuint unit) const { glBindTextureUnit(unit, name()); }

    GLuint name() const { return handle_.name(); }
    GLenum target() const { return target_; }
    explicit operator bool() const { return static_cast<bool>(handle_); }

  private:
    explicit Texture(GLenum target) : target_(target) {
        GLuint name = 0;
        glCreateTextures(target, 1, &name);
        handle_ = Handle<destroyTexture>(name);
    }
    Handle<destroyTexture> handle_;
    GLenum target_ = GL_TEXTURE_2D;
};

/// How a texture is looked up, where that is not the texture's own choice.
class Sampler {
  public:
    Sampler() = default;
    static Sampler create(GLenum minify, GLenum magnify, GLenum wrap) {
        GLuint name = 0;
        glCreateSamplers(1, &name);
        Sampler s;
        s.handle_ = Handle<destroySampler>(name);
        glSamplerParameteri(name, GL_TEXTURE_MIN_FILTER, static_cast<GLint>(minify));
        glSamplerParameteri(name, GL_TEXTURE_MAG_FILTER, static_cast<GLint>(magnify));
        for (GLenum axis : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
            glSamplerParameteri(name, axis, static_cast<GLint>(wrap));
        return s;
    }
    void bind(GLuint unit) const { glBindSampler(unit, name()); }
    GLuint name() const { return handle_.name(); }

  private:
    Handle<destroySampler> handle_;
};

}  // namespace reflection::gl
