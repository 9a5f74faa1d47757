#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
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

/// A chrome sphere in which another chrome reflector is seen, brought beside it.
struct PairShot {
    std::string name;
    View view;
    std::uint32_t sphere = 0, other = 0;  ///< indices into CityModel::reflectors
    glm::dvec3 foot{0};                   ///< where the other one is brought
};

/// Each sphere from near by, with another one 3 m from it (where they stand they are out of each other's
/// reach), both of chrome.
std::vector<PairShot> pairShots(const city::CityModel& city, glm::ivec2 resolution);

/// Brings the other one there.
void bringBeside(FrameScene& frame, const PairShot& shot);

/// Whether a pixel (rows run downwards) shows the other one within the sphere, by what they are: a ball, an
/// upright cylinder.
bool metTwice(const city::CityModel& city, const PairShot& shot, std::size_t pixel);

/// One of the frame's cars (whichever comes first; a frame without any stays as it is) parked with its flank
/// so many metres from a reflector's surface, to the right of who looks at it in a near shot.
void parkBeside(FrameScene& frame, const Scene& scene, std::uint32_t reflector, double apart);

/// Drives on to the moment within `seconds` at which most vehicles are near the reflectors: steps a traffic
/// started twice. Deterministic.
vehicles::Traffic busyTraffic(const Scene& scene, std::uint64_t seed, std::uint32_t cars, double seconds);

}  // namespace app
