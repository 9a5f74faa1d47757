#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

namespace reflection {

/// A reference environment map (Meyer & Loscos 2003, section 3): what one point of the static scene sees, in full
/// precision as it was rendered and as it is stored. Faces in CubeMapping's order, rows with growing t.
struct ReferenceMap {
    glm::dvec3 position{0};          ///< centre, world metres
    int faceSize = 0;                ///< texels
    std::vector<glm::vec3> colour;   ///< linear RGB radiance, 6 * faceSize^2
    std::vector<float> distance;     ///< metres from the centre, +infinity for sky, 6 * faceSize^2

    std::size_t texelCount() const { return 6 * static_cast<std::size_t>(faceSize) * static_cast<std::size_t>(faceSize); }
};

}  // namespace reflection
