#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "vehicles/traffic/VehiclePose.h"

namespace app {

/// Ids from here up to firstStandingId are those of staged vehicles.
inline constexpr std::uint32_t firstStagedId = 0x40000000u;

/// A vehicle that stands or drives where a user put it, whatever the traffic does: a parked car, a cyclist
/// who passes it. The traffic does not know of it. It mirrors and is mirrored as every other.
struct StagedVehicle {
    std::uint32_t model = 0;       ///< index into the scene's models
    std::vector<glm::dvec3> path;  ///< world metres, on the ground; one point: it stands there
    double heading = 0;            ///< of one that stands, radians from +x towards +y
    double speed = 0;              ///< metres per second along the path, then anew from its start
    double since = 0;  ///< seconds of the scene's time at which it starts
    float wheelRadius = 0.32f;     ///< metres
    glm::vec3 paint{0.5f};         ///< linear RGB
};

/// Where they are after so many seconds. Those without a path, or with a path without length, stand. Heading
/// and pitch turn evenly over two metres at the corners of a path.
std::vector<vehicles::VehiclePose> stagedPoses(std::span<const StagedVehicle> staged, double time);

}  // namespace app
