#pragma once

#include <cstdint>
#include <vector>

#include "city/model/CityModel.h"
#include "vehicles/models/VehicleModel.h"
#include "vehicles/traffic/VehiclePose.h"

namespace app {

// A city's standing reflectors are seen as vehicles are that never move: each is a model behind those of the
// traffic, and a pose behind the traffic's. So every method gives them maps, in the same plan, by the same
// budget, and rays, mirrors and other vehicles' maps show them; a map of theirs ages by what passes alone.

/// Ids from here on are those of standing reflectors; vehicles' are below.
inline constexpr std::uint32_t firstStandingId = 0x80000000u;

inline bool stands(const vehicles::VehiclePose& pose) {
    return pose.id >= firstStandingId;
}

/// One model for each of the city's reflectors, in their order.
std::vector<vehicles::VehicleModel> standingModels(const city::CityModel& city);

/// One pose for each, in their order; models are numbered from `firstModel`.
std::vector<vehicles::VehiclePose> standingPoses(const city::CityModel& city, std::uint32_t firstModel);

}  // namespace app
