#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "city/geometry/Aabb.h"
#include "city/model/CityModel.h"
#include "vehicles/traffic/VehiclePose.h"

namespace app {

enum class CameraMode : std::uint8_t {
    tour,    ///< along the city's tour, round and round
    follow,  ///< behind and beside a vehicle, which the mouse circles
    fly,     ///< free, but not under the ground
};

inline constexpr std::array<std::string_view, 3> cameraModeNames{"tour", "follow", "fly"};

/// What keys and mouse ask of the camera during one frame; plain data, so that it can come from a test as
/// well.
struct CameraInput {
    glm::dvec3 move{0};  ///< right, forward, up; -1 to 1
    glm::dvec2 look{0};  ///< radians: right, up
    double wheel = 0;    ///< notches; forward positive: nearer (follow) or faster (fly)
    bool fast = false;   ///< four times the speed
};

struct CameraPose {
    glm::dvec3 eye{0};
    glm::dvec3 target{1, 0, 0};  ///< differs from the eye
};

/// Where the camera is and how input moves it. Deterministic: the same calls give the same poses.
class CameraRig {
  public:
    /// `bounds`: of the city; its lowest point is the ground that flying stays above.
    /// A tour of fewer than two stops counts as none: the mode `tour` then follows a vehicle.
    CameraRig(std::span<const city::TourStop> tour, const city::Aabb& bounds);

    CameraMode mode() const { return mode_; }
    /// Changes the mode; flying starts where the camera is, following takes the vehicle that is nearest to
    /// it.
    void setMode(CameraMode mode, std::span<const vehicles::VehiclePose> vehicles);

    /// The vehicle that is followed: its id.
    std::optional<std::uint32_t> followed() const { return followed_; }
    void follow(std::uint32_t id) { followed_ = id; }
    /// Goes on to the next (or an earlier, for a negative step) vehicle in the list.
    void followNext(std::span<const vehicles::VehiclePose> vehicles, int step);

    /// A frame further. Non-finite or negative times count as 0.
    void update(double seconds, std::span<const vehicles::VehiclePose> vehicles, const CameraInput& input);

    const CameraPose& pose() const { return pose_; }
    bool hasTour() const { return tour_.size() >= 2; }
    /// Where the tour is after so many seconds from its start. Precondition: hasTour().
    CameraPose tourPose(double seconds) const;

  private:
    void followVehicle(double seconds, std::span<const vehicles::VehiclePose> vehicles,
                       const CameraInput& input);
    void fly(double seconds, const CameraInput& input);

    std::vector<city::TourStop> tour_;
    CameraMode mode_ = CameraMode::tour;
    CameraPose pose_;
    double tourTime_ = 0;
    std::optional<std::uint32_t> followed_;
    double heading_ = 0;      ///< smoothed heading of the followed vehicle
    bool settled_ = false;    ///< heading_ belongs to the followed vehicle
    double orbitYaw_ = 2.55;  ///< from the vehicle's heading to the camera's side: rear three-quarter view
    double orbitPitch_ = 0.2;
    double orbitDistance_ = 7;  ///< metres
    double flyYaw_ = 0;
    double flyPitch_ = 0;
    double flySpeed_ = 8;  ///< metres per second
    double lowest_;        ///< height below which flying does not go
};

}  // namespace app
