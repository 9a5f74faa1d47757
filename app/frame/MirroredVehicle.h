#pragma once

#include <functional>
#include <glm/vec3.hpp>
#include <vector>

#include "app/frame/Lighting.h"
#include "city/geometry/Mesh.h"
#include "reflection/local_map/MovingObjects.h"
#include "vehicles/models/VehicleModel.h"
#include "vehicles/traffic/VehiclePose.h"

namespace app {

/// A vehicle model as the local maps of other vehicles see it: its levels of detail, and a coarse wheel for
/// those whose bodies have none.
class MirroredVehicle {
  public:
    /// Keeps a reference to the model. Cost: some milliseconds.
    explicit MirroredVehicle(const vehicles::VehicleModel& model);

    /// Share of the sun's light that arrives at a point, world metres.
    using SunAt = std::function<float(const glm::dvec3&)>;

    /// The coarsest level that is off by no more than `allowedError` (metres; the finest where none is), lit,
    /// around a centre (world metres): what a local map there sees. Reuses the object's memory.
    void shade(const vehicles::VehiclePose& pose, const Lighting& lighting, const glm::dvec3& centre,
               float allowedError, const SunAt& sunAt, reflection::MovingObject& object) const;

    const vehicles::VehicleModel& model() const { return *model_; }

  private:
    const vehicles::VehicleModel* model_;
    city::Mesh wheel_;  ///< in the wheel's frame; empty: none
};

}  // namespace app
