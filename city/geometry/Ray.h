#pragma once

#include <glm/vec3.hpp>

namespace city {

/// A half line: the points origin + t * direction, t >= 0. The direction need not have unit length; t is
/// measured in multiples of it.
struct Ray {
    glm::vec3 origin{0};
    glm::vec3 direction{1, 0, 0};
};

}  // namespace city
