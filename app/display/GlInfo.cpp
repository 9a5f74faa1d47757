#include "app/display/GlInfo.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <array>
#include <string_view>

namespace app {

std::string glText(unsigned name) {
    const GLubyte* value = glGetString(name);
    return value == nullptr ? std::string() : std::string(reinterpret_cast<const char*>(value));
}

std::string glInfo() {
    const std::string renderer = glText(GL_RENDERER);
    if (renderer.empty()) return {};
    std::string info =
        "OpenGL renderer: " + renderer + (isSoftwareRenderer(renderer) ? " (software)" : "") + "\n";
    info += "OpenGL vendor: " + glText(GL_VENDOR) + "\n";
    info += "OpenGL version: " + glText(GL_VERSION) + "\n";
    info += "GLSL version: " + glText(GL_SHADING_LANGUAGE_VERSION) + "\n";
    struct Limit {
        GLenum name;
        const char* words;
    };
    constexpr std::array<Limit, 5> limits{{{GL_MAX_TEXTURE_SIZE, "largest texture"},
                                           {GL_MAX_CUBE_MAP_TEXTURE_SIZE, "largest cube face"},
                                           {GL_MAX_ARRAY_TEXTURE_LAYERS, "array layers"},
                                           {GL_MAX_UNIFORM_BLOCK_SIZE, "uniform block bytes"},
                                           {GL_MAX_SAMPLES, "samples a pixel"}}};
    for (const Limit& limit : limits) {
        GLint value = 0;
        glGetIntegerv(limit.name, &value);
        info += std::string(limit.words) + ": " + std::to_string(value) + "\n";
    }
    info += std::string("layers chosen in vertex shaders: ") +
            (epoxy_has_gl_extension("GL_ARB_shader_viewport_layer_array") ? "yes" : "no") + "\n";
    return info;
}

bool isSoftwareRenderer(const std::string& renderer) {
    constexpr std::array<std::string_view, 4> names{"llvmpipe", "softpipe", "swrast", "SWR"};
    return std::ranges::any_of(
        names, [&](std::string_view name) { return renderer.find(name) != std::string::npos; });
}

}  // namespace app
