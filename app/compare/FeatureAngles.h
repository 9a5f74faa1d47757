#pragma once

#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <optional>
#include <span>

#include "reflection/local_map/LocalMap.h"

namespace app {

/// A point of a vehicle that a pixel shows.
struct MirroringPoint {
    glm::dvec3 at{0};            ///< world metres
    glm::vec3 towards{0, 0, 1};  ///< unit: where the ray from the eye is mirrored to
    std::uint32_t vehicle = 0;   ///< id
};

/// The map in which a method looks up what a vehicle mirrors; of the map, its distances alone.
struct ShownMap {
    const reflection::LocalMap* map = nullptr;
    glm::dvec3 centre{0};   ///< where it was made
    bool parallax = false;  ///< whether it is looked up where a pixel's own ray ends
};

/// Mean angle, radians, between where points show a feature and where it truly lies, over the points that
/// show one nearer than the sky; not a number where there is none. `mapOf`: of a vehicle, nothing where its
/// method has no map whose distances are those of what it shows; asked whenever the vehicle differs from the
/// point's before, and its answer used until then.
double meanFeatureAngle(std::span<const MirroringPoint> points,
                        const std::function<std::optional<ShownMap>(std::uint32_t vehicle)>& mapOf);

}  // namespace app
