#pragma once

#include <glm/vec3.hpp>
#include <optional>

#include "app/frame/View.h"
#include "city/roads/RoadNetwork.h"

namespace app {

/// Height of the road that an eye looks at: that of the lane point nearest to `at` (world; heights do not
/// count). One plane stands for all wet ground of a frame: ground that lies e metres above or below it shows
/// an image that is 2 e metres too low or too high, which is 2 e / d radians at d metres of way from the eye
/// over the ground to what is mirrored; beyond 0.28 m the image fades, at 0.4 m there is none. Nothing
/// without lanes. Cost: points of all lanes.
std::optional<double> roadHeightNear(const city::RoadNetwork& roads, const glm::dvec3& at);

/// The same for a view: of the road in the middle of the picture rather than the one underfoot.
std::optional<double> roadSeenBy(const city::RoadNetwork& roads, const View& view);

}  // namespace app
