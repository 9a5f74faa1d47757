#pragma once

#include <cstdint>
#include <glm/vec3.hpp>

namespace vehicles {

/// Where a vehicle is and what can be seen of its motion. Plain data for drawing; no way back into the
/// simulation.
struct VehiclePose {
    std::uint32_t id = 0;     ///< stays with the vehicle for its life
    std::uint32_t model = 0;  ///< index into the caller's list of VehicleModel
    glm::dvec3 position{0};   ///< the vehicle frame's origin, world metres
    double heading = 0;       ///< radians from +x towards +y
    double pitch = 0;         ///< radians, nose up positive
    float speed = 0;          ///< metres per second
    float wheelAngle = 0;     ///< radians rolled, modulo 2 pi
    float steering = 0;       ///< radians, left positive
    glm::vec3 paint{0.5f};    ///< linear RGB
    bool braking = false;
};

}  // namespace vehicles
