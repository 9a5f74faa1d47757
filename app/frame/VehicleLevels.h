#pragma once

#include <cstdint>
#include <functional>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "vehicles/models/VehicleModel.h"
#include "vehicles/traffic/VehiclePose.h"

namespace app {

/// A vehicle model's levels of detail as they are drawn. Where the model's next level has less than a quarter
/// of the triangles, a level between is made; wheels get coarser levels too, as four fine wheels weigh more
/// than a coarse body.
struct VehicleLevels {
    struct Level {
        const city::Mesh* vertices = nullptr;  ///< whose vertices the indices name: in the model
        std::vector<std::uint32_t> indices;
        bool wheelsInBody = false;
        float error = 0;  ///< metres
    };
    std::vector<Level> bodies;  ///< finest first
    std::vector<Level> wheels;  ///< finest first; empty: no wheels of their own
    std::vector<vehicles::VehicleModel::Wheel> places;
    glm::vec3 centre{0};  ///< of the bounding box, steered wheels included; vehicle frame
    glm::vec3 halfSize{0};
    float radius = 0;  ///< of the bounding sphere around `centre`

    /// The coarsest of these levels that is off by no more than `allowed` metres; 0 for an empty list.
    static std::size_t choose(const std::vector<Level>& levels, float allowed);
};

/// Keeps pointers into the model. Cost: some tens of milliseconds.
VehicleLevels vehicleLevels(const vehicles::VehicleModel& model);

/// Where a wheel's mesh stands: rotation into the vehicle's frame.
glm::mat3 vehicleFromWheel(const vehicles::VehicleModel::Wheel& wheel, const vehicles::VehiclePose& pose);

}  // namespace app
