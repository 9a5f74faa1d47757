#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace reflection {

/// A reference environment map (Meyer & Loscos 2003, section 3): what one point of the static scene sees, in
/// full precision as it was rendered and as it is stored. Faces in CubeMapping's order, rows with growing t.
struct ReferenceMap {
    glm::dvec3 position{0};         ///< centre, world metres
    int faceSize = 0;               ///< texels
    std::vector<glm::vec3> colour;  ///< linear RGB radiance, 6 * faceSize^2
    std::vector<float> distance;    ///< metres from the centre, +infinity for sky, 6 * faceSize^2

    std::size_t texelCount() const {
        return 6 * static_cast<std::size_t>(faceSize) * static_cast<std::size_t>(faceSize);
    }
};

/// One distance for several samples of a texel (sorts them): the harmonic mean, exact on planes, of those
/// that belong to the surface of the median. Precondition: not empty.
float representativeDistance(std::span<float> samples);

/// The same map at half the size: mean colour and representative distance of each 2x2 texels. Precondition:
/// even face size.
ReferenceMap halved(const ReferenceMap& map);

}  // namespace reflection
