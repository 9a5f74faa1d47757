#pragma once

#include <glm/vec2.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/commands/LoadScene.h"
#include "app/frame/FrameScene.h"
#include "app/frame/View.h"
#include "vehicles/traffic/Traffic.h"

namespace app {

/// A look at a city's standing reflectors, from the side of the nearest lane, so that what drives there is
/// mirrored.
struct SquareShot {
    std::string name;
    View view;
    std::optional<std::uint32_t> reflector;  ///< index into CityModel::reflectors; nothing: all of them
};

/// Each reflector from near by (it fills half of the picture) and from 12 m, then all that stand together.
/// Empty for a city without any.
std::vector<SquareShot> squareShots(const city::CityModel& city, glm::ivec2 resolution);

/// One of the frame's cars (whichever comes first; a frame without any stays as it is) parked with its flank
/// so many metres from a reflector's surface, to the right of who looks at it in a near shot.
void parkBeside(FrameScene& frame, const Scene& scene, std::uint32_t reflector, double apart);

/// Drives on to the moment within `seconds` at which most vehicles are near the reflectors: steps a traffic
/// started twice. Deterministic.
vehicles::Traffic busyTraffic(const Scene& scene, std::uint64_t seed, std::uint32_t cars, double seconds);

}  // namespace app
