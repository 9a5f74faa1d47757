#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <span>

#include "app/frame/Lighting.h"
#include "reflection/local_map/MovingObjects.h"
#include "vehicles/models/VehicleModel.h"
#include "vehicles/traffic/VehiclePose.h"

namespace app {

/// Radiance that a point of a vehicle sends towards an eye, with the analytic environment in place of a map:
/// the twin of data/shaders/vehicle.vert and vehicle.frag without REFLECTIVE. `normal` and `towardsEye` unit
/// length, world frame.
glm::vec3 vehicleRadiance(const Lighting& lighting, vehicles::Surface surface,
                          const vehicles::VehiclePose& pose, const glm::vec3& normal,
                          const glm::vec3& towardsEye);

/// World rotation of a vehicle.
glm::mat3 worldFromVehicle(const vehicles::VehiclePose& pose);

/// The vehicle's coarsest level, lit, around a centre (world metres): what a local map there sees of it.
void shadeForLocalMap(const vehicles::VehicleModel& model, const vehicles::VehiclePose& pose,
                      const Lighting& lighting, const glm::dvec3& centre, reflection::MovingObject& object);

}  // namespace app
