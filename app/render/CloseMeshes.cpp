#include "app/render/CloseMeshes.h"

#include <algorithm>
#include <glm/common.hpp>
#include <limits>

#include "app/frame/VehicleShading.h"

namespace app {

namespace {

glm::dmat4 placed(const glm::mat3& turn, const glm::dvec3& origin) {
    return glm::dmat4(glm::dvec4(turn[0], 0), glm::dvec4(turn[1], 0), glm::dvec4(turn[2], 0),
                      glm::dvec4(origin, 1));
}

/// The vertices that the indices name, and no others.
std::unique_ptr<CloseMesh> meshFrom(const city::Mesh& mesh, const std::vector<std::uint32_t>& indices) {
    auto made = std::make_unique<CloseMesh>();
    made->attributes = {3, 3, 1};
    constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
    constexpr auto last = static_cast<std::uint32_t>(vehicles::Surface::count) - 1;
    std::vector<std::uint32_t> place(mesh.vertices.size(), none);
    for (const std::uint32_t index : indices) {
        if (place[index] == none) {
            place[index] = static_cast<std::uint32_t>(made->positions.size());
            const city::Vertex& v = mesh.vertices[index];
            made->positions.push_back(v.position);
            made->values.insert(made->values.end(),
                                {v.position.x, v.position.y, v.position.z, v.normal.x, v.normal.y, v.normal.z,
                                 static_cast<float>(std::min(v.material, last))});
        }
        made->indices.push_back(place[index]);
    }
    for (const glm::vec3& p : made->positions) made->box.extend(p);
    return made;
}

}  // namespace

std::vector<CloseMesh> closeMeshes(const CloseCityPatch& patch) {
    std::vector<CloseMesh> made;
    for (const auto* meshes : {&patch.solid, &patch.cutout})
        for (const city::Mesh& mesh : *meshes) {
            if (mesh.empty()) continue;
            CloseMesh& m = made.emplace_back();
            m.cutout = meshes == &patch.cutout;
            m.exact = true;
            m.indices = mesh.indices;
            m.attributes = {3, 2, 3, 1};
            for (const city::Vertex& v : mesh.vertices) {
                m.positions.push_back(v.position);
                m.box.extend(v.position);
                m.values.insert(m.values.end(),
                                {v.position.x, v.position.y, v.position.z, v.texcoord.x, v.texcoord.y,
                                 v.normal.x, v.normal.y, v.normal.z, static_cast<float>(v.material)});
            }
        }
    return made;
}

const VehicleLevels& CloseVehicles::levelsOf(std::size_t model) {
    const auto at = levels_.find(model);
    if (at != levels_.end()) return at->second;
    return levels_.emplace(model, vehicleLevels(models_[model])).first->second;
}

const CloseMesh& CloseVehicles::meshOf(const VehicleLevels::Level& level) {
    std::unique_ptr<CloseMesh>& made = meshes_[&level];
    if (!made) made = meshFrom(*level.vertices, level.indices);
    return *made;
}

std::span<const CloseVehicles::Placed> CloseVehicles::of(const vehicles::VehiclePose& pose, float allowed) {
    placed_.clear();
    if (pose.model >= models_.size()) return placed_;
    const VehicleLevels& levels = levelsOf(pose.model);
    if (levels.bodies.empty()) return placed_;
    const glm::mat3 turn = worldFromVehicle(pose);
    const VehicleLevels::Level& body = levels.bodies[VehicleLevels::choose(levels.bodies, allowed)];
    placed_.push_back({&meshOf(body), placed(turn, pose.position)});
    if (body.wheelsInBody || levels.wheels.empty()) return placed_;
    const CloseMesh& wheelMesh = meshOf(levels.wheels[VehicleLevels::choose(levels.wheels, allowed)]);
    for (const vehicles::VehicleModel::Wheel& wheel : levels.places)
        placed_.push_back({&wheelMesh, placed(turn * vehicleFromWheel(wheel, pose),
                                              pose.position + glm::dvec3(turn * wheel.centre))});
    return placed_;
}

city::Aabb CloseVehicles::boxOf(const vehicles::VehiclePose& pose) {
    city::Aabb box;
    if (pose.model >= models_.size()) return box;
    const VehicleLevels& levels = levelsOf(pose.model);
    if (levels.bodies.empty()) return box;
    box.extend(levels.centre - levels.halfSize);
    box.extend(levels.centre + levels.halfSize);
    return box;
}

}  // namespace app
