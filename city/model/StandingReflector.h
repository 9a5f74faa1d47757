#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <string>

#include "city/geometry/Mesh.h"

namespace city {

/// A polished body that stands in the city and mirrors it: a sphere or an upright cylinder. It is no part of
/// the city's chunks, since what it shows depends on who looks: reference maps and the heightfield do not
/// know it (a map that had seen it would show another eye's reflections on it, and nothing behind it), views
/// draw it with a map of its own as they draw vehicles. It casts its shadow as the city does.
struct StandingReflector {
    enum class Shape : std::uint8_t { sphere, pillar };
    enum class Stuff : std::uint8_t {
        chrome,
        granite,  ///< black and polished: dark, but for a twentieth of the light, more at grazing angles
    };
    std::string name;
    Shape shape = Shape::sphere;
    Stuff stuff = Stuff::chrome;
    glm::vec3 foot{0};  ///< its lowest point on its axis, world metres
    float radius = 1;   ///< metres
    float height = 2;   ///< metres; of a sphere twice the radius

    glm::vec3 centre() const { return foot + glm::vec3(0, 0, 0.5f * height); }
};

/// Its surface around its foot, axis upwards, outside outwards, with the body's exact normals; material 0.
/// `detail` 0 to 5: each more halves the edges of a sphere (20 x 4^detail triangles) and the angles of a
/// pillar (6 x 2^detail sides, a lid, no floor). Empty where radius or height is not positive and finite.
Mesh reflectorMesh(const StandingReflector& reflector, int detail);

/// Metres by which that mesh lies inside the body at most.
float reflectorMeshError(const StandingReflector& reflector, int detail);

}  // namespace city
