#pragma once

#include <glm/vec3.hpp>

#include "city/model/CityModel.h"
#include "vehicles/traffic/Traffic.h"

namespace app {

/// The one lamp of a signal head that is lit: a disc that faces as the head does, seen from its front alone.
struct SignalLamp {
    static constexpr float radius = 0.1f;  ///< metres: lenses of 200 mm
    glm::vec3 centre{0};                   ///< world
    glm::vec3 radiance{0};
};

/// Red above, amber in the middle, green below.
inline SignalLamp litLamp(const city::SignalHead& head, vehicles::SignalColour colour) {
    constexpr float spacing = 0.27f;  // metres between lamp centres
    constexpr float ahead = 0.16f;    // metres in front of the head's middle: before its housing
    const bool red = colour == vehicles::SignalColour::red;
    const bool amber = colour == vehicles::SignalColour::amber;
    const glm::vec3 up(0, 0, red ? spacing : amber ? 0.f : -spacing);
    return {head.position + up + ahead * head.facing, red     ? glm::vec3(5, 0.25f, 0.1f)
                                                      : amber ? glm::vec3(4.5f, 2, 0.1f)
                                                              : glm::vec3(0.2f, 3.6f, 1.6f)};
}

}  // namespace app
