#include "reflection/gl/SoftwareRenderer.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <array>
#include <string_view>

namespace reflection {

bool softwareRenderer() {
    constexpr std::array<std::string_view, 5> names{"llvmpipe", "softpipe", "swrast", "SWR", "SwiftShader"};
    const auto* text = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
    const std::string_view renderer = text != nullptr ? text : "";
    return std::ranges::any_of(names,
                               [&](std::string_view name) { return renderer.find(name) != renderer.npos; });
}

}  // namespace reflection
