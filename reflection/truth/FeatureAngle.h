#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>

#include "reflection/local_map/LocalMap.h"

namespace reflection {

/// Error of position: the angle, radians, at a point of a reflector between the direction in which a feature
/// is shown there and the direction in which it truly lies, 0 .. pi. The feature is the point that the method
/// took its colour from. Nothing where it cannot be defined: the feature at the reflector's own point, a
/// direction without length, or values that are not finite.
std::optional<double> featureAngle(const glm::dvec3& at, const glm::dvec3& shownTowards,
                                   const glm::dvec3& feature);

/// The point that an environment map shows in a direction, by its own distances: what `featureAngle` takes
/// for a map that is looked up by direction alone. `centre`: the map's, which may differ from the reflector's
/// point and from where the reflector is now. Nearest texel. Nothing for the sky, whose angle is zero.
std::optional<glm::dvec3> featureShown(const LocalMap& map, const glm::dvec3& centre,
                                       const glm::vec3& direction);

}  // namespace reflection
