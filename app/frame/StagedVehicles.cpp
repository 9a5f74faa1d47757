#include "app/frame/StagedVehicles.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace app {

namespace {

/// Half the way along which a corner of a path is rounded, metres.
constexpr double cornerReach = 1;

double lengthOf(const std::vector<glm::dvec3>& path) {
    double length = 0;
    for (std::size_t i = 1; i < path.size(); ++i) length += glm::distance(path[i - 1], path[i]);
    return length;
}

/// So far along a path; its ends beyond them.
glm::dvec3 along(const std::vector<glm::dvec3>& path, double way) {
    for (std::size_t i = 1; i < path.size(); ++i) {
        const double step = glm::distance(path[i - 1], path[i]);
        if (way <= step && step > 0) return glm::mix(path[i - 1], path[i], std::max(way, 0.0) / step);
        way -= step;
    }
    return path.back();
}

}  // namespace

std::vector<vehicles::VehiclePose> stagedPoses(std::span<const StagedVehicle> staged, double time) {
    std::vector<vehicles::VehiclePose> poses;
    std::uint32_t id = firstStagedId;
    for (const StagedVehicle& vehicle : staged) {
        vehicles::VehiclePose pose;
        pose.id = id++;
        pose.model = vehicle.model;
        pose.paint = vehicle.paint;
        pose.heading = vehicle.heading;
        if (vehicle.path.empty()) continue;
        pose.position = vehicle.path.front();
        const double length = lengthOf(vehicle.path);
        if (length > 0) {
            const double gone = std::max(vehicle.speed * (time - vehicle.since), 0.0);
            const double way = vehicle.speed > 0 ? std::fmod(gone, length) : 0;
            pose.position = along(vehicle.path, way);
            const double reach = std::min(cornerReach, 0.5 * length);
            const double middle = std::clamp(way, reach, length - reach);
            const glm::dvec3 towards =
                along(vehicle.path, middle + reach) - along(vehicle.path, middle - reach);
            if (glm::length(towards) > 0) {
                pose.heading = std::atan2(towards.y, towards.x);
                pose.pitch = std::asin(std::clamp(towards.z / glm::length(towards), -1.0, 1.0));
            }
            pose.speed = static_cast<float>(vehicle.speed);
            pose.wheelAngle = static_cast<float>(
                std::fmod(gone / static_cast<double>(vehicle.wheelRadius), 2 * std::numbers::pi));
        }
        poses.push_back(pose);
    }
    return poses;
}

}  // namespace app
