#include "app/commands/StoneShots.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

namespace app {

namespace {

constexpr std::size_t frontsTried = 24;
constexpr double eyeHeight = 1.5;   // metres
constexpr double fieldOfView = 50;  // degrees
constexpr glm::ivec2 glance(96, 54);

}  // namespace

std::optional<View> stoneShot(const Scene& scene, const RayTracer& rays, glm::ivec2 resolution) {
    std::vector<const city::GlassFront*> stones;
    for (const city::GlassFront& front : scene.glass.fronts)
        if (front.glass == city::polishedGranite) stones.push_back(&front);
    std::ranges::stable_sort(stones, [](const auto* a, const auto* b) { return a->area > b->area; });
    stones.resize(std::min(stones.size(), frontsTried));
    std::optional<View> best;
    std::size_t most = 0;
    TraceOptions quick;
    quick.plain = true;
    quick.windows = quick.film = 1;
    for (const city::GlassFront* front : stones) {
        const glm::dvec3 middle = 0.5 * (front->outline[0] + front->outline[2]);
        const glm::dvec3 along(-front->normal.y, front->normal.x, 0);
        for (const double side : {-1.0, 1.0}) {
            glm::dvec3 eye = middle + 3.2 * front->normal + side * 4.5 * along;
            eye.z = front->outline[0].z + eyeHeight;
            const glm::dvec3 target(glm::dvec2(middle), front->outline[0].z + 0.9);
            const View small = lookAt(eye, target, glm::radians(fieldOfView), glance);
            const TracedPicture picture = rays.render(small, quick);
            const auto count = [&](SeenKind kind) {
                return static_cast<std::size_t>(std::ranges::count(picture.kind, kind));
            };
            const std::size_t seen = std::min(count(SeenKind::stone), count(SeenKind::frosted));
            if (seen <= most) continue;
            most = seen;
            best = lookAt(eye, target, glm::radians(fieldOfView), resolution);
        }
    }
    return best;
}

}  // namespace app
