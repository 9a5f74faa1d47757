#pragma once

#include <epoxy/gl.h>

#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <initializer_list>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "reflection/gl/Handle.h"

namespace reflection::gl {

inline void destroyProgram(std::uint32_t name) {
    glDeleteProgram(name);
}

/// A linked GL program made from files in data/shaders.
class Program {
  public:
    Program() = default;
    /// Stages are told by the files' endings: .vert .geom .frag .comp. Throws std::runtime_error with file
    /// names and the compiler's message when a file is missing or does not compile.
    static Program fromFiles(std::initializer_list<std::string_view> files,
                             const std::vector<std::string>& defines = {});

    void use() const { glUseProgram(name()); }

    /// Uniforms by name; a name that the program does not use is ignored, as the compiler may have removed
    /// it.
    void set(const char* uniform, int value) const { glProgramUniform1i(name(), location(uniform), value); }
    void set(const char* uniform, float value) const { glProgramUniform1f(name(), location(uniform), value); }
    void set(const char* uniform, const glm::ivec2& v) const {
        glProgramUniform2i(name(), location(uniform), v.x, v.y);
    }
    void set(const char* uniform, const glm::vec2& v) const {
        glProgramUniform2f(name(), location(uniform), v.x, v.y);
    }
    void set(const char* uniform, const glm::vec3& v) const {
        glProgramUniform3f(name(), location(uniform), v.x, v.y, v.z);
    }
    void set(const char* uniform, const glm::vec4& v) const {
        glProgramUniform4f(name(), location(uniform), v.x, v.y, v.z, v.w);
    }
    void set(const char* uniform, const glm::mat3& m) const {
        glProgramUniformMatrix3fv(name(), location(uniform), 1, GL_FALSE, &m[0][0]);
    }
    void set(const char* uniform, const glm::mat4& m) const {
        glProgramUniformMatrix4fv(name(), location(uniform), 1, GL_FALSE, &m[0][0]);
    }

    GLuint name() const { return handle_.name(); }
    explicit operator bool() const { return static_cast<bool>(handle_); }

  private:
    GLint location(const char* uniform) const;
    Handle<destroyProgram> handle_;
    mutable std::unordered_map<std::string, GLint> locations_;
};

}  // namespace reflection::gl
