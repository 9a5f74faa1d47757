#pragma once

#include "app/frame/FrameScene.h"
#include "city/model/CityModel.h"

namespace app {

/// What is seen now: the traffic's vehicles and signals, under a light, in these views, and behind the
/// vehicles the city's standing reflectors, whose models follow those of the traffic's kinds
/// (StandingReflectors.h). Cost: vehicles + signal heads.
FrameScene assembleFrame(const city::CityModel& city, const vehicles::Traffic& traffic,
                         const Lighting& lighting, std::vector<View> views);

/// The standing city alone under a light: no vehicles, nor reflectors that stand in it, all signals red. What
/// reference maps are drawn from.
FrameScene emptyFrame(const city::CityModel& city, const Lighting& lighting);

}  // namespace app
