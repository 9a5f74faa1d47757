#pragma once

#include <optional>
#include <span>
#include <vector>

#include "app/frame/CameraRig.h"
#include "vehicles/traffic/Traffic.h"

namespace app {

/// Cuts between shots, as in a film: beside a car whose paint shows the street, then along the city's tour,
/// and so on.
class ShotPlan {
  public:
    /// `mode`: stay in this one; nothing: alternate.
    ShotPlan(std::optional<CameraMode> mode, std::vector<vehicles::VehicleKind> kinds);

    /// Sets the rig's mode and the car to follow where a new shot begins at this time (seconds, growing from
    /// 0).
    void direct(double time, std::span<const vehicles::VehiclePose> vehicles, CameraRig& rig);

  private:
    std::optional<CameraMode> mode_;
    std::vector<vehicles::VehicleKind> kinds_;
    std::optional<int> shot_;
};

}  // namespace app
