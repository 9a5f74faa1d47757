#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "app/frame/Lighting.h"
#include "vehicles/models/VehicleModel.h"
#include "vehicles/traffic/VehiclePose.h"

namespace app {

/// What data/shaders/vehicle.vert works out for a vertex, to be interpolated over triangles.
struct CoatedVertex {
    glm::vec3 diffuse{0};  ///< outgoing radiance of the layer under the coat
    float f0 = 0;          ///< reflectance at normal incidence
    float coat = 0;        ///< 1: a polished coat, whose reflectance grows towards grazing angles
    float sun = 1;         ///< share of the sun's light that arrives
};
CoatedVertex coatedVertex(const Lighting& lighting, vehicles::Surface surface,
                          const vehicles::VehiclePose& pose, const glm::vec3& normal, float sun);

/// Share of the light that the coat mirrors; facing: cosine towards the eye (Schlick).
float coatFresnel(const CoatedVertex& point, float facing);

/// What a vehicle without a map mirrors in a direction: the sky's mean, the ground's, and the sun's glint.
glm::vec3 plainSurroundings(const Lighting& lighting, const CoatedVertex& point, const glm::vec3& reflected);

/// Radiance that a point of a vehicle sends towards an eye, with the analytic environment in place of a map:
/// the twin of data/shaders/vehicle.vert and vehicle.frag without REFLECTIVE. `normal` and `towardsEye` unit
/// length, world frame; `sun`: share of its light that arrives.
glm::vec3 vehicleRadiance(const Lighting& lighting, vehicles::Surface surface,
                          const vehicles::VehiclePose& pose, const glm::vec3& normal,
                          const glm::vec3& towardsEye, float sun = 1);

/// World rotation of a vehicle.
glm::mat3 worldFromVehicle(const vehicles::VehiclePose& pose);

}  // namespace app
