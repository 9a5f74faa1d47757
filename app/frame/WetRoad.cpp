#include "app/frame/WetRoad.h"

#include <algorithm>
#include <glm/vec2.hpp>
#include <limits>

namespace app {

std::optional<double> roadHeightNear(const city::RoadNetwork& roads, const glm::dvec3& at) {
    double nearest = std::numeric_limits<double>::infinity();
    std::optional<double> height;
    for (const city::Lane& lane : roads.lanes) {
        if (lane.kind == city::LaneKind::tram) continue;
        for (std::size_t i = 0; i < lane.centreLine.size(); ++i) {
            const glm::dvec3 a(lane.centreLine[i]);
            const glm::dvec3 b(lane.centreLine[std::min(i + 1, lane.centreLine.size() - 1)]);
            const glm::dvec2 way(b - a), from(at - a);
            const double square = way.x * way.x + way.y * way.y;
            const double t =
                square > 0 ? std::clamp((from.x * way.x + from.y * way.y) / square, 0.0, 1.0) : 0;
            const glm::dvec2 off = from - t * way;
            const double distance = off.x * off.x + off.y * off.y;
            if (!(distance < nearest)) continue;
            nearest = distance;
            height = a.z + t * (b.z - a.z);
        }
    }
    return height;
}

std::optional<double> roadSeenBy(const city::RoadNetwork& roads, const View& view) {
    constexpr double ahead = 15;  // metres
    const glm::mat4& v = view.viewFromWorld;
    return roadHeightNear(roads, view.eye - ahead * glm::dvec3(v[0][2], v[1][2], v[2][2]));
}

}  // namespace app
