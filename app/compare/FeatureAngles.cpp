#include "app/compare/FeatureAngles.h"

#include <limits>

#include "reflection/local_map/Parallax.h"
#include "reflection/truth/FeatureAngle.h"

namespace app {

double meanFeatureAngle(std::span<const MirroringPoint> points,
                        const std::function<std::optional<ShownMap>(std::uint32_t vehicle)>& mapOf) {
    std::optional<std::uint32_t> vehicle;
    std::optional<ShownMap> shown;
    double sum = 0;
    std::size_t count = 0;
    for (const MirroringPoint& point : points) {
        if (vehicle != point.vehicle) {
            vehicle = point.vehicle;
            shown = mapOf(point.vehicle);
        }
        if (!shown || shown->map == nullptr) continue;
        const glm::vec3 direction =
            shown->parallax
                ? reflection::lookedUpTowards(*shown->map, glm::vec3(point.at - shown->centre), point.towards)
                : point.towards;
        const std::optional<glm::dvec3> feature =
            reflection::featureShown(*shown->map, shown->centre, direction);
        if (!feature) continue;
        const std::optional<double> angle =
            reflection::featureAngle(point.at, glm::dvec3(point.towards), *feature);
        if (!angle) continue;
        sum += *angle;
        ++count;
    }
    return count == 0 ? std::numeric_limits<double>::quiet_NaN() : sum / static_cast<double>(count);
}

}  // namespace app
