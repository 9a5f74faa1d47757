#include "app/raytrace/VehicleTiles.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/vec4.hpp>

#include "app/frame/VehicleShading.h"

namespace app {

VehicleTiles::VehicleTiles(const FrameScene& frame, std::span<const std::uint32_t> chosen,
                           const RayMeshes& meshes, const View& view) {
    grid_ = (view.size + side - 1) / side;
    marked_.resize(static_cast<std::size_t>(grid_.x) * static_cast<std::size_t>(grid_.y));
    const glm::mat4 clipFromRelative = view.clipFromView * view.viewFromWorld;
    for (const std::uint32_t index : chosen) {
        const vehicles::VehiclePose& pose = frame.vehicles[index];
        if (pose.model >= meshes.vehicles().size()) continue;
        const VehicleLevels& levels = meshes.vehicles()[pose.model].levels;
        const glm::mat3 rotation = worldFromVehicle(pose);
        const glm::vec3 position(pose.position - view.eye);
        glm::vec2 low(static_cast<float>(view.size.x), static_cast<float>(view.size.y)), high(0);
        for (int corner = 0; corner < 8; ++corner) {
            const glm::vec3 sign((corner & 1) != 0 ? 1 : -1, (corner & 2) != 0 ? 1 : -1,
                                 (corner & 4) != 0 ? 1 : -1);
            const glm::vec3 p = position + rotation * (levels.centre + sign * levels.halfSize);
            const glm::vec4 clip = clipFromRelative * glm::vec4(p, 1);
            if (clip.w < 1e-3f) {  // beside or behind the eye: anywhere
                low = glm::vec2(0);
                high = glm::vec2(view.size);
                break;
            }
            const glm::vec2 at = (glm::vec2(clip.x, -clip.y) / clip.w * 0.5f + 0.5f) * glm::vec2(view.size);
            low = glm::min(low, at);
            high = glm::max(high, at);
        }
        const glm::ivec2 first = glm::ivec2(glm::floor(glm::max(low - 1.0f, 0.0f))) / side;
        const glm::ivec2 last =
            glm::ivec2(glm::floor(glm::min(high + 1.0f, glm::vec2(view.size) - 1.0f))) / side;
        for (int y = first.y; y <= last.y && high.y >= 0; ++y)
            for (int x = first.x; x <= last.x && high.x >= 0; ++x)
                marked_[static_cast<std::size_t>(y) * static_cast<std::size_t>(grid_.x) +
                        static_cast<std::size_t>(x)] = 1;
    }
    for (int y = 0; y < grid_.y; ++y)
        for (int x = 0; x < grid_.x; ++x)
            if (covers(x * side, y * side))
                tiles_.push_back(
                    {glm::ivec2(x, y) * side, glm::min(glm::ivec2(x + 1, y + 1) * side, view.size)});
}

}  // namespace app
