#pragma once

#include <vector>

#include "vehicles/models/VehicleModel.h"
#include "vehicles/traffic/Traffic.h"

namespace vehicles {

/// The built-in vehicles, in this order: hatchback, saloon, van, bus, tram.
std::vector<VehicleModel> builtInFleet();

/// What the simulation must know of each model: index i speaks of models[i].
std::vector<VehicleKind> kindsOf(const std::vector<VehicleModel>& models);

}  // namespace vehicles
