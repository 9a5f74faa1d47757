#pragma once

#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "city/geometry/Mesh.h"

namespace vehicles {

/// What a vertex of a vehicle is made of: the value of city::Vertex::material in vehicle meshes.
enum class Surface : std::uint32_t {
    paint,  ///< the instance's colour under a clear coat
    glass,
    chrome,
    tyre,
    rim,
    headLamp,
    tailLamp,
    trim,  ///< black plastic, grilles, underbody
    interior,
    polishedStone,  ///< black granite: of no vehicle, but of what stands in a city and mirrors as they do
    cloth,          ///< the instance's colour, matt
    skin,
    count
};

/// Frame of a vehicle: x forward, y left, z up, origin on the road under the middle of the wheelbase; metres.
struct VehicleModel {
    struct Level {
        city::Mesh body;            ///< everything but the wheels, or with them (see below)
        bool wheelsInBody = false;  ///< far levels carry their wheels as fixed geometry
        float error = 0;            ///< metres by which the level may differ from level 0
    };
    struct Wheel {
        glm::vec3 centre{0};  ///< the wheel mesh's origin goes here; it turns about its y axis
        bool steered = false;
        bool mirrored = false;  ///< right-hand side: the mesh turned by pi about z
    };
    std::string name;
    float length = 4.5f;  ///< metres
    float width = 1.8f;
    float height = 1.5f;
    float wheelRadius = 0.32f;
    /// Share of the height at which what it mirrors is gathered: the middle of the painted body, a little
    /// above half of it.
    float reflectionCentre = 0.55f;
    std::vector<Level> levels;  ///< finest first, at least one
    city::Mesh wheel;           ///< left-hand wheel, axle along y, outside towards +y; empty: none
    std::vector<Wheel> wheels;
};

}  // namespace vehicles
