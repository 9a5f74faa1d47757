#pragma once

#include <span>
#include <vector>

#include "city/model/CityModel.h"

namespace city {

/// A point that the camera passes, and what it looks at while it does.
struct TourKey {
    glm::vec3 eye{0};
    glm::vec3 target{1, 0, 0};
    float speed = 6;  ///< metres per second from here to the next key
};

/// One stop a second or so on a smooth curve (Catmull-Rom) through the keys. Fewer than two keys give no
/// tour.
std::vector<TourStop> makeTour(std::span<const TourKey> keys);

}  // namespace city
