#pragma once

#include <span>

#include "app/frame/ChromeParts.h"
#include "app/frame/CloseCity.h"
#include "city/model/CityModel.h"
#include "vehicles/models/VehicleModel.h"

namespace app {

/// A pillar with round ends above its top and below its foot, around its foot: smooth, and closed.
city::Mesh roundedPillar(const city::StandingReflector& pillar);

/// What chrome may show of close things, and the chrome itself: made once for a city and its vehicles.
struct CloseScene {
    /// Keeps references to both.
    CloseScene(const city::CityModel& city, std::span<const vehicles::VehicleModel> vehicleModels);

    std::span<const vehicles::VehicleModel> models;
    ChromeParts parts;
    CloseCity standing;
};

}  // namespace app
