#include "app/frame/MirroredVehicle.h"

#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <limits>

#include "app/frame/VehicleLevels.h"
#include "app/frame/VehicleShading.h"

namespace app {

namespace {

/// The vertices that the indices name, and no others.
city::Mesh compacted(const city::Mesh& mesh, const std::vector<std::uint32_t>& indices) {
    constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
    std::vector<std::uint32_t> place(mesh.vertices.size(), none);
    city::Mesh compact;
    for (const std::uint32_t index : indices) {
        if (place[index] == none) {
            place[index] = static_cast<std::uint32_t>(compact.vertices.size());
            compact.vertices.push_back(mesh.vertices[index]);
        }
        compact.indices.push_back(place[index]);
    }
    return compact;
}

}  // namespace

MirroredVehicle::MirroredVehicle(const vehicles::VehicleModel& model) : model_(&model) {
    const VehicleLevels levels = vehicleLevels(model);
    if (!levels.wheels.empty())
        wheel_ = compacted(*levels.wheels.back().vertices, levels.wheels.back().indices);
}

void MirroredVehicle::shade(const vehicles::VehiclePose& pose, const Lighting& lighting,
                            const glm::dvec3& centre, float allowedError, const SunAt& sunAt,
                            reflection::MovingObject& object) const {
    object.positions.clear();
    object.radiance.clear();
    object.indices.clear();
    const std::vector<vehicles::VehicleModel::Level>& levels = model_->levels;
    if (levels.empty()) return;
    std::size_t level = 0;
    while (level + 1 < levels.size() && levels[level + 1].error <= allowedError) ++level;

    const glm::mat3 rotation = worldFromVehicle(pose);
    const auto add = [&](const city::Mesh& mesh, const glm::mat3& turn, const glm::vec3& offset) {
        const auto first = static_cast<std::uint32_t>(object.positions.size());
        for (const city::Vertex& v : mesh.vertices) {
            const glm::vec3 position = offset + turn * v.position;
            const float distance = glm::length(position);
            const glm::vec3 towardsEye = distance > 0 ? -position / distance : glm::vec3(0, 0, 1);
            object.positions.push_back(position);
            object.radiance.push_back(vehicleRadiance(lighting, static_cast<vehicles::Surface>(v.material),
                                                      pose, turn * v.normal, towardsEye,
                                                      sunAt(centre + glm::dvec3(position))));
        }
        for (const std::uint32_t index : mesh.indices) object.indices.push_back(first + index);
    };
    const glm::vec3 offset(pose.position - centre);
    add(levels[level].body, rotation, offset);
    if (levels[level].wheelsInBody || wheel_.vertices.empty()) return;
    for (const vehicles::VehicleModel::Wheel& wheel : model_->wheels)
        add(wheel_, rotation * vehicleFromWheel(wheel, pose), offset + rotation * wheel.centre);
}

}  // namespace app
