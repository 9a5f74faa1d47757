#include "app/render/ChangedParts.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "app/frame/SignalLamp.h"

namespace app {

namespace {

/// Pixels around a box: an edge that is smoothed reaches over its border.
constexpr float margin = 1;
/// Nearer than this to the plane of the eye nothing is drawn, metres.
constexpr float nearest = 0.05f;
/// Lengths of shadow for each metre of height that are followed: longer ones are faint at their ends.
constexpr float longestShadow = 3;

city::Aabb withShadow(city::Aabb box, const glm::vec3& towardsSun) {
    if (box.empty()) return box;
    const float height = box.size().z;
    const glm::vec2 across(towardsSun);
    const float steep = std::max(towardsSun.z, glm::length(across) / longestShadow);
    const glm::vec2 reach = steep > 0 ? -across * (height / steep) : glm::vec2(0);
    const glm::vec3 low = box.min, high = box.max;
    box.extend(low + glm::vec3(reach, 0));
    box.extend(glm::vec3(high.x + reach.x, high.y + reach.y, low.z));
    return box;
}

}  // namespace

std::optional<glm::ivec4> pixelsOf(const city::Aabb& box, const glm::dvec3& eye,
                                   const glm::mat4& clipFromRelative, glm::ivec2 size) {
    if (box.empty() || size.x <= 0 || size.y <= 0) return std::nullopt;
    glm::vec2 low(std::numeric_limits<float>::infinity()), high = -low;
    glm::vec4 corners[8];
    for (int c = 0; c < 8; ++c) {
        const glm::vec3 corner((c & 1) != 0 ? box.max.x : box.min.x, (c & 2) != 0 ? box.max.y : box.min.y,
                               (c & 4) != 0 ? box.max.z : box.min.z);
        corners[c] = clipFromRelative * glm::vec4(glm::vec3(glm::dvec3(corner) - eye), 1);
    }
    const auto add = [&](const glm::vec4& clip) {
        const glm::vec2 at = (glm::vec2(clip) / clip.w * 0.5f + 0.5f) * glm::vec2(size);
        low = glm::min(low, at);
        high = glm::max(high, at);
    };
    for (int c = 0; c < 8; ++c) {
        if (corners[c].w >= nearest) add(corners[c]);
        // Where an edge passes behind the eye: as far as it is in front.
        for (const int axis : {1, 2, 4}) {
            const glm::vec4 &a = corners[c], &b = corners[c ^ axis];
            if (a.w >= nearest && b.w < nearest) add(glm::mix(a, b, (a.w - nearest) / (a.w - b.w)));
        }
    }
    if (!(low.x <= high.x)) return std::nullopt;
    low = glm::clamp(low - margin, glm::vec2(0), glm::vec2(size));
    high = glm::clamp(high + margin, glm::vec2(0), glm::vec2(size));
    const glm::ivec4 pixels(glm::ivec2(glm::floor(low)), glm::ivec2(glm::ceil(high)));
    if (pixels.x >= pixels.z || pixels.y >= pixels.w) return std::nullopt;
    return pixels;
}

void findChanges(
    const MovingParts& was, std::span<const vehicles::VehiclePose> poses,
    std::span<const vehicles::SignalColour> colours, std::span<const city::SignalHead> heads,
    const glm::vec3& towardsSun, const std::function<city::Aabb(const vehicles::VehiclePose&)>& boundsOf,
    const std::function<bool(const vehicles::VehiclePose&, const vehicles::VehiclePose&)>& noticed,
    const std::function<void(std::uint64_t, const city::Aabb&)>& changed) {
    std::vector<vehicles::VehiclePose> now(poses.begin(), poses.end()), old = was.poses;
    std::ranges::sort(now, {}, &vehicles::VehiclePose::id);
    std::ranges::sort(old, {}, &vehicles::VehiclePose::id);
    const auto tell = [&](const vehicles::VehiclePose& pose) {
        changed(pose.id, withShadow(boundsOf(pose), towardsSun));
    };
    auto before = old.begin();
    for (const vehicles::VehiclePose& pose : now) {
        for (; before != old.end() && before->id < pose.id; ++before) tell(*before);
        const bool known = before != old.end() && before->id == pose.id;
        if (!known || before->model != pose.model || noticed(*before, pose)) {
            if (known) tell(*before);
            tell(pose);
        }
        if (known) ++before;
    }
    for (; before != old.end(); ++before) tell(*before);

    for (std::size_t i = 0; i < std::min({heads.size(), colours.size(), was.colours.size()}); ++i) {
        if (colours[i] == was.colours[i]) continue;
        city::Aabb box;
        for (const vehicles::SignalColour colour : {colours[i], was.colours[i]}) {
            const glm::vec3 lamp = litLamp(heads[i], colour).centre;
            box.extend(lamp - SignalLamp::radius);
            box.extend(lamp + SignalLamp::radius);
        }
        changed((std::uint64_t{1} << 32) + i, box);
    }
}

}  // namespace app
