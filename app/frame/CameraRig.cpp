#include "app/frame/CameraRig.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

namespace app {

namespace {

constexpr double pi = std::numbers::pi;
/// Seconds in which the camera catches up with 63% of a turn of the vehicle: slow enough not to swing at
/// junctions.
constexpr double headingLag = 0.6;
constexpr double steepest = 1.5;  ///< radians; short of straight up, where yaw loses its meaning
constexpr double nearest = 2.5;   ///< metres from a followed vehicle's middle
constexpr double farthest = 150;
constexpr double lowestFlight = 0.3;  ///< metres above the ground: under a car's bumper, not under the road

double wrapped(double angle) {
    return std::remainder(angle, 2 * pi);
}

glm::dvec3 direction(double yaw, double pitch) {
    return {std::cos(yaw) * std::cos(pitch), std::sin(yaw) * std::cos(pitch), std::sin(pitch)};
}

const vehicles::VehiclePose* find(std::span<const vehicles::VehiclePose> vehicles,
                                  std::optional<std::uint32_t> id) {
    const auto found =
        std::find_if(vehicles.begin(), vehicles.end(), [&](const auto& v) { return v.id == id; });
    return found == vehicles.end() ? nullptr : &*found;
}

std::optional<std::uint32_t> nearestVehicle(std::span<const vehicles::VehiclePose> vehicles,
                                            const glm::dvec3& point) {
    const auto distance = [&](const auto& v) { return glm::dot(v.position - point, v.position - point); };
    const auto best = std::min_element(vehicles.begin(), vehicles.end(), [&](const auto& a, const auto& b) {
        return distance(a) < distance(b);
    });
    return best == vehicles.end() ? std::nullopt : std::optional(best->id);
}

/// Cubic Hermite curve between b and c, with the tangents that their outer neighbours at uneven times
/// suggest.
glm::dvec3 smooth(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d,
                  double ta, double tb, double tc, double td, double t) {
    const double length = tc - tb;
    const glm::dvec3 slopeB = (c - a) / std::max(tc - ta, 1e-9);
    const glm::dvec3 slopeC = (d - b) / std::max(td - tb, 1e-9);
    const double s = (t - tb) / length;
    const double s2 = s * s;
    const double s3 = s2 * s;
    return (2 * s3 - 3 * s2 + 1) * b + (s3 - 2 * s2 + s) * length * slopeB + (3 * s2 - 2 * s3) * c +
           (s3 - s2) * length * slopeC;
}

}  // namespace

CameraRig::CameraRig(std::span<const city::TourStop> tour, const city::Aabb& bounds)
    : lowest_(bounds.empty() ? -std::numeric_limits<double>::infinity()
                             : static_cast<double>(bounds.min.z) + lowestFlight) {
    for (const city::TourStop& stop : tour)
        if (tour_.empty() || stop.time > tour_.back().time) tour_.push_back(stop);
    if (hasTour()) {
        pose_ = tourPose(0);
    } else {
        // Above the south-west corner, looking at the middle.
        const glm::dvec3 centre = bounds.empty() ? glm::dvec3(0) : glm::dvec3(bounds.centre());
        const double size = bounds.empty() ? 100 : glm::length(glm::dvec2(bounds.size().x, bounds.size().y));
        pose_ = {centre + glm::dvec3(-0.3, -0.3, 0.25) * std::max(size, 10.0), centre};
    }
}

CameraPose CameraRig::tourPose(double seconds) const {
    const double start = tour_.front().time;
    const double length = tour_.back().time - start;
    const double t = start + std::fmod(std::max(0.0, seconds), length);
    std::size_t next = 1;
    while (next + 1 < tour_.size() && tour_[next].time <= t) ++next;
    const city::TourStop& b = tour_[next - 1];
    const city::TourStop& c = tour_[next];
    const city::TourStop& a = next >= 2 ? tour_[next - 2] : b;
    const city::TourStop& d = next + 1 < tour_.size() ? tour_[next + 1] : c;
    const auto between = [&](auto member) {
        return smooth(glm::dvec3(a.*member), glm::dvec3(b.*member), glm::dvec3(c.*member),
                      glm::dvec3(d.*member), a.time, b.time, c.time, d.time, t);
    };
    CameraPose pose{between(&city::TourStop::eye), between(&city::TourStop::target)};
    if (glm::length(pose.target - pose.eye) < 1e-6) pose.target = pose.eye + glm::dvec3(1, 0, 0);
    return pose;
}

void CameraRig::setMode(CameraMode mode, std::span<const vehicles::VehiclePose> vehicles) {
    if (mode == CameraMode::fly) {
        const glm::dvec3 forward = glm::normalize(pose_.target - pose_.eye);
        flyYaw_ = std::atan2(forward.y, forward.x);
        flyPitch_ = std::clamp(std::asin(std::clamp(forward.z, -1.0, 1.0)), -steepest, steepest);
    }
    if (mode == CameraMode::follow) {
        followed_ = nearestVehicle(vehicles, pose_.eye);
        settled_ = false;
    }
    mode_ = mode;
}

void CameraRig::followNext(std::span<const vehicles::VehiclePose> vehicles, int step) {
    if (vehicles.empty()) return;
    const auto count = static_cast<std::ptrdiff_t>(vehicles.size());
    const vehicles::VehiclePose* now = find(vehicles, followed_);
    const std::ptrdiff_t index =
        now == nullptr ? 0 : ((now - vehicles.data()) + step % count + count) % count;
    followed_ = vehicles[static_cast<std::size_t>(index)].id;
    settled_ = false;
}

void CameraRig::update(double seconds, std::span<const vehicles::VehiclePose> vehicles,
                       const CameraInput& input) {
    if (!(seconds > 0) || !std::isfinite(seconds)) seconds = 0;
    switch (mode_) {
        case CameraMode::tour:
            if (!hasTour()) {
                followVehicle(seconds, vehicles, input);
                break;
            }
            tourTime_ += seconds;
            pose_ = tourPose(tourTime_);
            break;
        case CameraMode::follow:
            followVehicle(seconds, vehicles, input);
            break;
        case CameraMode::fly:
            fly(seconds, input);
            break;
    }
}

void CameraRig::followVehicle(double seconds, std::span<const vehicles::VehiclePose> vehicles,
                              const CameraInput& input) {
    const vehicles::VehiclePose* vehicle = find(vehicles, followed_);
    if (vehicle == nullptr) {
        // The vehicle has left the city, or there was none yet.
        followed_ = nearestVehicle(vehicles, pose_.eye);
        settled_ = false;
        vehicle = find(vehicles, followed_);
        if (vehicle == nullptr) return;
    }
    if (!settled_) heading_ = vehicle->heading;
    settled_ = true;
    heading_ =
        wrapped(heading_ + wrapped(vehicle->heading - heading_) * (1 - std::exp(-seconds / headingLag)));
    orbitYaw_ = wrapped(orbitYaw_ - input.look.x + input.move.x * seconds);
    orbitPitch_ = std::clamp(orbitPitch_ - input.look.y, 0.02, steepest);
    orbitDistance_ = std::clamp(orbitDistance_ * std::pow(0.88, input.wheel + 4 * input.move.y * seconds),
                                nearest, farthest);

    const glm::dvec3 middle = vehicle->position + glm::dvec3(0, 0, 0.9);
    pose_.eye = middle + orbitDistance_ * direction(heading_ + orbitYaw_, orbitPitch_);
    pose_.target = middle;
}

void CameraRig::fly(double seconds, const CameraInput& input) {
    flyYaw_ = wrapped(flyYaw_ - input.look.x);
    flyPitch_ = std::clamp(flyPitch_ + input.look.y, -steepest, steepest);
    flySpeed_ = std::clamp(flySpeed_ * std::pow(1.2, input.wheel), 0.5, 200.0);
    const glm::dvec3 forward = direction(flyYaw_, flyPitch_);
    const glm::dvec3 right(std::sin(flyYaw_), -std::cos(flyYaw_), 0);
    const double step = flySpeed_ * (input.fast ? 4 : 1) * seconds;
    pose_.eye += step * (input.move.x * right + input.move.y * forward + input.move.z * glm::dvec3(0, 0, 1));
    pose_.eye.z = std::max(pose_.eye.z, lowest_);
    pose_.target = pose_.eye + forward;
}

}  // namespace app
