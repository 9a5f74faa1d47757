#include "app/commands/ChromeClip.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <optional>

#include "app/frame/ChromePlan.h"
#include "app/frame/CloseScene.h"
#include "app/frame/StandingReflectors.h"

namespace app {

namespace {

// Metres: of the eye from the chrome and above it, and of the other vehicle's middle from it.
constexpr double eyeAway = 1.5, eyeAbove = 0.4, otherBehind = 3.5, otherBeside = 2.2;

/// The vehicle nearest to the eye among those with the widest whole chrome, and that part.
struct Choice {
    std::uint32_t vehicle = 0, part = 0;
};
std::optional<Choice> choose(const FrameScene& frame, const CloseScene& close) {
    std::optional<Choice> best;
    double widest = 0, nearest = 0;
    for (std::uint32_t v = 0; v < frame.vehicles.size(); ++v) {
        const vehicles::VehiclePose& pose = frame.vehicles[v];
        if (stands(pose)) continue;
        const std::span<const ChromePart> parts = close.parts.of(pose.model);
        for (std::uint32_t p = 0; p < parts.size(); ++p) {
            if (!parts[p].closed || !parts[p].convex || parts[p].onWheel) continue;
            const auto width = static_cast<double>(parts[p].width);
            const double away = glm::distance(pose.position, frame.views.front().eye);
            if (best && (width < widest || (width == widest && away >= nearest))) continue;
            best = {v, p};
            widest = width;
            nearest = away;
        }
    }
    return best;
}

}  // namespace

DetailBench::Clip chromeClip(const Scene& scene, const CloseScene& close, const DetailBench::Clip& like,
                             glm::ivec2 resolution) {
    const std::optional<Choice> choice = choose(like.front(), close);
    if (!choice) return {};
    const auto find = [](FrameScene& frame, std::uint32_t id) {
        return std::ranges::find(frame.vehicles, id, &vehicles::VehiclePose::id);
    };
    const vehicles::VehiclePose& own = like.front().vehicles[choice->vehicle];
    const auto beside = std::ranges::find_if(like.front().vehicles, [&](const vehicles::VehiclePose& p) {
        return p.id != own.id && !stands(p) && p.model < scene.models.size();
    });
    if (beside == like.front().vehicles.end()) return {};
    DetailBench::Clip clip;
    for (const FrameScene& from : like) {
        FrameScene& frame = clip.emplace_back(from);
        const auto chosen = find(frame, own.id), other = find(frame, beside->id);
        if (chosen == frame.vehicles.end() || other == frame.vehicles.end()) return {};
        const auto number = static_cast<std::uint32_t>(chosen - frame.vehicles.begin());
        const ChromePart& part = close.parts.of(chosen->model)[choice->part];
        const ChromeJob job = chromePartAt(frame.vehicles, scene.models, part, number, choice->part,
                                           ChromeJob::noWheel, ChromePlanOptions{}.closeRadii);
        const glm::dvec3 place(job.worldFromPart[3]);
        const glm::dvec3 ahead(std::cos(chosen->heading), std::sin(chosen->heading), 0);
        const glm::dvec3 left(-ahead.y, ahead.x, 0);
        const glm::dvec3 out = glm::dot(place - chosen->position, ahead) < 0 ? -ahead : ahead;
        other->position = chosen->position + glm::dot(place - chosen->position, ahead) * ahead +
                          otherBehind * out + otherBeside * left;
        other->heading = chosen->heading;
        const glm::dvec3 eye = place + eyeAway * out - 0.3 * eyeAway * left + glm::dvec3(0, 0, eyeAbove);
        frame.views = {lookAt(eye, place, glm::radians(60.0), resolution)};
    }
    return clip;
}

}  // namespace app
