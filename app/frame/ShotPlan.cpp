#include "app/frame/ShotPlan.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>

namespace app {

namespace {

constexpr double shotLength = 5;    // seconds
constexpr float longestCar = 6.5f;  // metres; a longer vehicle would fill the picture
constexpr float cruising = 4;       // metres per second; a car that stands shows a still street

/// The car nearest to a point, moving ones before standing ones.
std::optional<std::uint32_t> carNear(const glm::dvec3& point, std::span<const vehicles::VehiclePose> vehicles,
                                     std::span<const vehicles::VehicleKind> kinds,
                                     std::optional<std::uint32_t> butNot) {
    std::optional<std::uint32_t> best;
    double bestCost = std::numeric_limits<double>::infinity();
    for (const vehicles::VehiclePose& v : vehicles) {
        const bool car =
            v.model < kinds.size() && !kinds[v.model].tram && kinds[v.model].length <= longestCar;
        // Every fault outweighs any distance within a city.
        double cost = glm::distance(v.position, point) + (car ? 0 : 4e5) + (v.speed >= cruising ? 0 : 1e5);
        if (v.id == butNot) cost += 8e5;
        if (cost < bestCost) {
            bestCost = cost;
            best = v.id;
        }
    }
    return best;
}

}  // namespace

ShotPlan::ShotPlan(std::optional<CameraMode> mode, std::vector<vehicles::VehicleKind> kinds)
    : mode_(mode), kinds_(std::move(kinds)) {}

void ShotPlan::direct(double time, std::span<const vehicles::VehiclePose> vehicles, CameraRig& rig) {
    const int shot = static_cast<int>(std::floor(time / shotLength));
    if (shot_ == shot) return;
    const bool first = !shot_;
    shot_ = shot;
    const bool follow = mode_ ? *mode_ == CameraMode::follow : (shot % 2 == 0 || !rig.hasTour());
    // A tour or a flight that was asked for is not cut.
    if (!follow) {
        if (first || !mode_) rig.setMode(mode_.value_or(CameraMode::tour), vehicles);
        return;
    }
    if (mode_ && !first) return;
    const std::optional<std::uint32_t> before = rig.followed();
    const glm::dvec3 eye = rig.pose().eye;
    rig.setMode(CameraMode::follow, vehicles);
    if (const auto car = carNear(eye, vehicles, kinds_, before)) rig.follow(*car);
}

}  // namespace app
