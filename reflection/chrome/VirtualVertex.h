#pragma once

#include <glm/vec3.hpp>

#include "reflection/chrome/ReflectionPoint.h"

namespace reflection {

/// What a virtual vertex is drawn with.
struct VirtualVertex {
    /// In the reflector's frame relative to the eye, metres: lies on the line of sight through the reflection
    /// point, as far away as the light's whole path is long. Its direction places it on screen, its length
    /// orders it in depth among everything reflected in the same piece.
    glm::vec3 fromEye{0};
    ReflectionStatus status = ReflectionStatus::invalid;
};

}  // namespace reflection
