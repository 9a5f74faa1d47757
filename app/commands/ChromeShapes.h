#pragma once

#include <cstddef>
#include <filesystem>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/stability/SeededRandom.h"
#include "city/geometry/Mesh.h"
#include "reflection/chrome/ReflectorPieces.h"

namespace app {

/// A shape on which searches are measured.
struct ChromeShape {
    std::string name;
    reflection::Reflector reflector;
    glm::dvec3 centre{0};
    double radius = 1;         ///< metres, of the ball around it
    glm::dvec3 from{1, 0, 0};  ///< unit length, where its front is seen from
};

/// A ball, an ellipsoid, a rounded cylinder, a bowl's inside, a car's widest chrome in front (its bumper),
/// and its front up to its bonnet's edge: the built-in saloon's, or that of a GLB scaled to a length in
/// metres. Throws std::runtime_error for a file that cannot be read.
std::vector<ChromeShape> chromeShapes(const std::optional<std::filesystem::path>& car, double carLength);

/// Points around a shape, from half its ball's radius to six radii away, evenly spread over the magnitudes.
std::vector<glm::dvec3> verticesAround(const ChromeShape& shape, std::size_t count,
                                       stability::SeededRandom& random);

}  // namespace app
