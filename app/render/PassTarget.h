#pragma once

#include <epoxy/gl.h>

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "app/render/Frustum.h"
#include "app/render/Skyline.h"
#include "reflection/planar/Portal.h"

namespace app {

/// What a pass draws into: display colours, linear radiance and distance, or depth alone.
enum class PassTarget : std::uint8_t { view, cube, depth };
inline constexpr std::size_t passTargetCount = 3;

inline std::vector<std::string> definesFor(PassTarget target, std::vector<std::string> more = {}) {
    if (target == PassTarget::cube) {
        more.emplace_back("CUBE");
        if (epoxy_has_gl_extension("GL_ARB_shader_viewport_layer_array")) more.emplace_back("LAYERED");
    }
    if (target == PassTarget::depth) more.emplace_back("DEPTH");
    return more;
}

/// The eye of one draw: a view, or one face of a cube.
struct PassView {
    glm::dvec3 eye{0};
    glm::mat4 clipFromRelative{1};
    Frustum frustum{glm::mat4(1)};
    float pixelsPerRadian = 700;  ///< near the middle of the image; of parallel views: pixels per metre
    bool parallel = false;
    const SkylineView* skyline = nullptr;  ///< what hides behind buildings; null: nothing is left out
    /// Of a view through a mirror: what is seen through its polygon, relative to the eye; null: the frustum
    /// alone tells.
    const reflection::HalfSpaces* portal = nullptr;

    /// Whether something (world) needs drawing: it may be seen.
    bool sees(const city::Aabb& box) const {
        if (!frustum.touches(box.centre() - glm::vec3(eye), 0.5f * box.size())) return false;
        if (portal != nullptr &&
            !reflection::touches(*portal, glm::dvec3(box.centre()) - eye, glm::dvec3(0.5f * box.size())))
            return false;
        return skyline == nullptr || !skyline->hides(box);
    }

    PassView(const glm::dvec3& eyePosition, const glm::mat4& clip, float pixels)
        : eye(eyePosition), clipFromRelative(clip), frustum(clip), pixelsPerRadian(pixels) {}

    /// Metres by which what is drawn `distance` metres away may be off, for an error of `tolerance` pixels.
    float allowedError(float tolerance, float distance) const {
        return tolerance * (parallel ? 1.f : distance) / pixelsPerRadian;
    }
};

}  // namespace app
