#pragma once

#include <vector>

#include "app/frame/Lighting.h"
#include "app/frame/View.h"
#include "vehicles/traffic/Traffic.h"
#include "vehicles/traffic/VehiclePose.h"

namespace app {

/// What is to be seen in one frame: plain data, from traffic and camera towards the plan, never back.
struct FrameScene {
    double time = 0;          ///< seconds
    std::vector<View> views;  ///< all displays and eyes of this frame
    /// What mirrors by a map of its own: vehicles, then what stands in the city and does as they do.
    std::vector<vehicles::VehiclePose> vehicles;
    std::vector<vehicles::SignalColour> signalColours;  ///< one per CityModel::signalHeads
    Lighting lighting;
    /// Times the light's exposure, of all views: what the viewer's eye or camera has adapted to
    /// (EyeAdaptation).
    double adaptation = 1;
};

}  // namespace app
