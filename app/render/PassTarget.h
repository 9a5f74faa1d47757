#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "app/render/Frustum.h"

namespace app {

/// What a pass draws into: display colours, or linear radiance and distance.
enum class PassTarget : std::uint8_t { view, cube };

inline std::vector<std::string> definesFor(PassTarget target, std::vector<std::string> more = {}) {
    if (target == PassTarget::cube) more.emplace_back("CUBE");
    return more;
}

/// The eye of one draw: a view, or one face of a cube.
struct PassView {
    glm::dvec3 eye{0};
    glm::mat4 clipFromRelative{1};
    Frustum frustum{glm::mat4(1)};
    float pixelsPerRadian = 700;  ///< near the middle of the image

    PassView(const glm::dvec3& eyePosition, const glm::mat4& clip, float pixels)
        : eye(eyePosition), clipFromRelative(clip), frustum(clip), pixelsPerRadian(pixels) {}
};

}  // namespace app
