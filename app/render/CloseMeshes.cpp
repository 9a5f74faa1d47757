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

/// Metres from a part up to which it mirrors its own body: what is farther stands behind it, or is small.
constexpr float ownReach = 0.6f;
/// Metres before a part's surface up to which chrome is the part itself: its levels of detail are off by as
/// much.
constexpr double skin = 0.004;

/// How far before the surface of the part a place of its frame is, metres, as seen from the middles of its
/// pieces; below 0 within it.
double before(const reflection::Reflector& reflector, const glm::dvec3& place) {
    double least = std::numeric_limits<double>::infinity();
    for (const reflection::ReflectorPiece& piece : reflector.pieces) {
        const reflection::ReflectorMap& map = piece.built.map;
        if (map.empty()) continue;
        const glm::dvec3 p = map.frame().toMap(place);
        const reflection::ReflectorMap::Sample at = map.sample(p);
        least = std::min(least, map.frame().scale * glm::dot(p - at.position, at.normal));
    }
    return least;
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

const CloseMesh* CloseVehicles::besides(std::size_t model, const ChromePart& part, std::uint32_t number,
                                        const reflection::Reflector& reflector, float allowed) {
    if (model >= models_.size()) return nullptr;
    const VehicleLevels& levels = levelsOf(model);
    if (levels.bodies.empty()) return nullptr;
    const VehicleLevels::Level& level = levels.bodies[VehicleLevels::choose(levels.bodies, allowed)];
    std::unique_ptr<CloseMesh>& made = besides_[{&level, number}];
    if (!made) {
        constexpr auto chrome = static_cast<std::uint32_t>(vehicles::Surface::chrome);
        const std::vector<city::Vertex>& vertices = level.vertices->vertices;
        std::vector<std::uint32_t> kept;
        for (std::size_t k = 0; k + 2 < level.indices.size(); k += 3) {
            bool near = false, within = true, itself = true;
            for (std::size_t c = 0; c < 3; ++c) {
                const city::Vertex& v = vertices[level.indices[k + c]];
                const glm::vec3 off = glm::max(glm::abs(v.position - part.centre) - part.half, glm::vec3(0));
                near = near || glm::dot(off, off) < ownReach * ownReach;
                const double d = off == glm::vec3(0) ? before(reflector, glm::dvec3(v.position - part.centre))
                                                     : std::max(static_cast<double>(glm::length(off)), 0.0);
                within = within && d <= 0;
                itself = itself && v.material == chrome && d < skin;
            }
            if (near && !within && !itself)
                kept.insert(kept.end(), {level.indices[k], level.indices[k + 1], level.indices[k + 2]});
        }
        made = meshFrom(*level.vertices, kept);
    }
    return made->indices.empty() ? nullptr : made.get();
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
