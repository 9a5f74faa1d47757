#include "app/raytrace/RayScene.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "app/frame/SignalLamp.h"
#include "app/frame/VehicleShading.h"

namespace app {

namespace {

/// As app/render/SceneRenderer.cpp has them.
constexpr float levelTolerance = 2.5f;
constexpr float foliageTolerance = 10;

glm::mat4 affine(const glm::mat3& r, const glm::vec3& t) {
    return {glm::vec4(r[0], 0), glm::vec4(r[1], 0), glm::vec4(r[2], 0), glm::vec4(t, 1)};
}

}  // namespace

DetailRule DetailRule::of(const View& view) {
    return {view.eye, 0.5f * static_cast<float>(view.size.y) * std::abs(view.clipFromView[1][1])};
}

void RayScene::clear() {
    traced_.clear();
    placed_.clear();
}

void RayScene::place(const PlacedMesh& thing) {
    if (thing.mesh == RayMeshes::none) return;
    traced_.place(thing.mesh, thing.worldFromMesh);
    placed_.push_back(thing);
}

void RayScene::addCity(const city::CityModel& city, const DetailRule& detail) {
    if (detail.pixelsPerRadian <= 0 && meshes_->whole() != RayMeshes::none) {
        place({PlacedMesh::Kind::city, meshes_->whole(), 0, glm::mat4(1), glm::vec3(0)});
        return;
    }
    place({PlacedMesh::Kind::city, meshes_->chunks(), 0, glm::mat4(1), glm::vec3(0)});
    const glm::vec3 eye(detail.eye);
    for (const city::Placement& placement : city.placements) {
        if (placement.prototype >= meshes_->prototypes().size()) continue;
        const RayMeshes::Prototype& prototype = meshes_->prototypes()[placement.prototype];
        if (prototype.levels.empty()) continue;
        const glm::mat4& m = placement.worldFromPrototype;
        std::size_t level = 0;
        if (detail.pixelsPerRadian > 0) {
            // CityPass::draw.
            const float scale = std::max(
                {glm::length(glm::vec3(m[0])), glm::length(glm::vec3(m[1])), glm::length(glm::vec3(m[2]))});
            const float radius = prototype.radius * scale;
            const float away = glm::length(glm::vec3(m * glm::vec4(prototype.centre, 1)) - eye);
            if (away / detail.pixelsPerRadian > 2 * radius) continue;  // smaller than a pixel
            const float allowed = foliageTolerance * std::max(away - radius, 0.1f) / detail.pixelsPerRadian /
                                  std::max(scale, 1e-6f);
            while (level + 1 < prototype.levels.size() && prototype.levels[level + 1].error <= allowed)
                ++level;
        }
        place({PlacedMesh::Kind::city, prototype.levels[level].mesh, 0, m, glm::vec3(0)});
    }
}

void RayScene::addLamps(const city::CityModel& city, const FrameScene& frame, const DetailRule& detail) {
    for (std::size_t i = 0; i < std::min(city.signalHeads.size(), frame.signalColours.size()); ++i) {
        const city::SignalHead& head = city.signalHeads[i];
        const SignalLamp lamp = litLamp(head, frame.signalColours[i]);
        if (detail.pixelsPerRadian > 0) {
            // SignalLamps::draw.
            const glm::vec3 position(glm::dvec3(lamp.centre) - detail.eye);
            if (glm::dot(position, head.facing) > 0) continue;
            if (0.5f * glm::length(position) / detail.pixelsPerRadian > 2 * SignalLamp::radius) continue;
        }
        // lamp.vert's axes.
        const glm::vec3 side =
            glm::normalize(glm::cross(glm::vec3(0, 0, 1), head.facing + glm::vec3(1e-5f, 0, 0)));
        const glm::vec3 up = glm::cross(head.facing, side);
        const glm::mat3 axes(head.facing, SignalLamp::radius * side, SignalLamp::radius * up);
        place({PlacedMesh::Kind::lamp, meshes_->lamp(), 0, affine(axes, lamp.centre), lamp.radiance});
    }
}

void RayScene::addVehicles(const FrameScene& frame, std::span<const std::uint32_t> chosen,
                           const DetailRule& detail) {
    for (const std::uint32_t index : chosen) {
        const vehicles::VehiclePose& pose = frame.vehicles[index];
        if (pose.model >= meshes_->vehicles().size()) continue;
        const RayMeshes::Vehicle& vehicle = meshes_->vehicles()[pose.model];
        const VehicleLevels& levels = vehicle.levels;
        if (levels.bodies.empty()) continue;
        const glm::mat3 rotation = worldFromVehicle(pose);
        const glm::vec3 position(pose.position);
        float allowed = 0;
        if (detail.pixelsPerRadian > 0) {
            // VehiclePass::draw.
            const glm::vec3 centre = glm::vec3(pose.position - detail.eye) + rotation * levels.centre;
            const float distance = std::max(glm::length(centre) - levels.radius, 0.1f);
            allowed = levelTolerance * distance / detail.pixelsPerRadian;
        }
        const std::size_t level = VehicleLevels::choose(levels.bodies, allowed);
        place({PlacedMesh::Kind::vehicle, vehicle.bodies[level], index, affine(rotation, position),
               glm::vec3(0)});
        if (levels.bodies[level].wheelsInBody || levels.wheels.empty()) continue;
        const std::uint32_t wheelMesh = vehicle.wheels[VehicleLevels::choose(levels.wheels, allowed)];
        for (const vehicles::VehicleModel::Wheel& wheel : levels.places)
            place({PlacedMesh::Kind::vehicle, wheelMesh, index,
                   affine(rotation * vehicleFromWheel(wheel, pose), position + rotation * wheel.centre),
                   glm::vec3(0)});
    }
}

}  // namespace app
