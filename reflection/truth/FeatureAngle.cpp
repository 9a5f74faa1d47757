#include "reflection/truth/FeatureAngle.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "reflection/local_map/Parallax.h"

namespace reflection {

std::optional<double> featureAngle(const glm::dvec3& at, const glm::dvec3& shownTowards,
                                   const glm::dvec3& feature) {
    const glm::dvec3 truly = feature - at;
    // The angle between two vectors without the loss that the arc cosine has near zero.
    const double across = glm::length(glm::cross(shownTowards, truly)), along = glm::dot(shownTowards, truly);
    if (!std::isfinite(across) || !std::isfinite(along) || (across == 0 && along == 0)) return std::nullopt;
    return std::atan2(across, along);
}

std::optional<glm::dvec3> featureShown(const LocalMap& map, const glm::dvec3& centre,
                                       const glm::vec3& direction) {
    const float depth = depthTowards(map, direction);
    if (!std::isfinite(depth)) return std::nullopt;
    return centre + static_cast<double>(depth) *
                        glm::dvec3(direction / std::max({std::abs(direction.x), std::abs(direction.y),
                                                         std::abs(direction.z)}));
}

}  // namespace reflection
