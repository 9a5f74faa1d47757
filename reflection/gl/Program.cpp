#include "reflection/gl/Program.h"

#include <stdexcept>

#include "reflection/gl/ShaderSource.h"

namespace reflection::gl {

namespace {

GLenum stageOf(std::string_view file) {
    if (file.ends_with(".vert")) return GL_VERTEX_SHADER;
    if (file.ends_with(".geom")) return GL_GEOMETRY_SHADER;
    if (file.ends_with(".frag")) return GL_FRAGMENT_SHADER;
    if (file.ends_with(".comp")) return GL_COMPUTE_SHADER;
    throw std::runtime_error(std::string(file) +
                             ": not a shader's name; it must end in .vert, .geom, .frag or .comp.");
}

void destroyShader(std::uint32_t name) {
    glDeleteShader(name);
}

Handle<destroyShader> compile(std::string_view file, const std::vector<std::string>& defines) {
    const ShaderSource source = loadShader(file, defines);
    Handle<destroyShader> shader(glCreateShader(stageOf(file)));
    const char* text = source.text.c_str();
    glShaderSource(shader.name(), 1, &text, nullptr);
    glCompileShader(shader.name());
    GLint ok = 0;
    glGetShaderiv(shader.name(), GL_COMPILE_STATUS, &ok);
    if (ok == 0) {
        std::string log(8192, '\0');
        GLsizei length = 0;
        glGetShaderInfoLog(shader.name(), static_cast<GLsizei>(log.size()), &length, log.data());
        log.resize(static_cast<std::size_t>(length));
        std::string files;
        for (std::size_t i = 0; i < source.files.size(); ++i)
            files += " " + std::to_string(i) + "=" + source.files[i];
        throw std::runtime_error("data/shaders/" + std::string(file) +
                                 ": the OpenGL driver does not compile it (source strings" + files + "):\n" +
                                 log + "Update the driver, or restore the file.");
    }
    return shader;
}

}  // namespace

Program Program::fromFiles(std::initializer_list<std::string_view> files,
                           const std::vector<std::string>& defines) {
    Program program;
    program.handle_ = Handle<destroyProgram>(glCreateProgram());
    std::vector<Handle<destroyShader>> shaders;
    std::string names;
    for (std::string_view file : files) {
        shaders.push_back(compile(file, defines));
        glAttachShader(program.name(), shaders.back().name());
        names += (names.empty() ? "" : " + ") + std::string(file);
    }
    glLinkProgram(program.name());
    GLint ok = 0;
    glGetProgramiv(program.name(), GL_LINK_STATUS, &ok);
    if (ok == 0) {
        std::string log(8192, '\0');
        GLsizei length = 0;
        glGetProgramInfoLog(program.name(), static_cast<GLsizei>(log.size()), &length, log.data());
        log.resize(static_cast<std::size_t>(length));
        throw std::runtime_error("data/shaders: the OpenGL driver does not link " + names + ":\n" + log +
                                 "Update the driver, or restore the files.");
    }
    for (const auto& shader : shaders) glDetachShader(program.name(), shader.name());
    return program;
}

GLint Program::location(const char* uniform) const {
    const auto [it, isNew] = locations_.try_emplace(uniform, -1);
    if (isNew) it->second = glGetUniformLocation(name(), uniform);
    return it->second;
}

}  // namespace reflection::gl
