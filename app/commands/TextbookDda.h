#pragma once

#include <span>

#include "city/geometry/Ray.h"
#include "city/terrain/Heightfield.h"

namespace app {

/// The grid walk as it is usually written (Amanatides & Woo 1987): float parameters that accumulate, one ray
/// at a time. The yardstick of `bench tracer`, not for use: it may miss at borders and corners. The ray
/// starts inside the field. Returns the ray parameter of the hit, +infinity on a miss.
float textbookDda(const city::Heightfield& field, float highest, const city::Ray& ray);

}  // namespace app
