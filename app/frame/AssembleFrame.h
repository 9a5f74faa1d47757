#pragma once

#include <span>

#include "app/frame/FrameScene.h"
#include "app/frame/StagedVehicles.h"
#include "city/model/CityModel.h"

namespace app {

/// What is seen now: the traffic's vehicles and signals, under a light, in these views, behind the vehicles
/// those that are staged, and behind these the city's standing reflectors, whose models follow those of the
/// traffic's kinds (StandingReflectors.h). Cost: vehicles + signal heads.
FrameScene assembleFrame(const city::CityModel& city, const vehicles::Traffic& traffic,
                         const Lighting& lighting, std::vector<View> views,
                         std::span<const StagedVehicle> staged = {});

/// The standing city alone under a light: no vehicles, nor reflectors that stand in it, all signals red. What
/// reference maps are drawn from.
FrameScene emptyFrame(const city::CityModel& city, const Lighting& lighting);

}  // namespace app
