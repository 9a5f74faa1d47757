#pragma once

#include "vehicles/models/VehicleModel.h"

namespace vehicles {

/// The built-in vehicles, one file each: a control cage, the lines drawn on its limit surface, and small
/// parts.
VehicleModel hatchback();
VehicleModel saloon();
VehicleModel van();
VehicleModel bus();
VehicleModel tram();
/// A bicycle with its rider, who does not pedal. No part of the traffic: see app/frame/StagedVehicles.
VehicleModel cyclist();

}  // namespace vehicles
