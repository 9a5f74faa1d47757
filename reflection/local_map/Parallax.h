#pragma once

#include <glm/vec3.hpp>

#include "reflection/local_map/LocalMap.h"

namespace reflection {

/// Depth (LocalMap::depth) of the texel that a direction of any length falls into; not a number without a
/// direction or without texels.
float depthTowards(const LocalMap& map, const glm::vec3& direction);

/// The direction in which a map is looked up for a ray that starts off its centre, by the distances that it
/// keeps: the processor's twin of data/shaders/vehicle.frag, with the nearest texel's distance. `from`:
/// metres from the centre; `towards`: unit length. `towards` itself where the map shows the sky there, or has
/// no texels.
///
/// Exact where what the ray meets is plane and seen from the centre: 1 / distance is then linear in the
/// direction, and one secant ends at the root.
glm::vec3 lookedUpTowards(const LocalMap& map, const glm::vec3& from, const glm::vec3& towards);

}  // namespace reflection
