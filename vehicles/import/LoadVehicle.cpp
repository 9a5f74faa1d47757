#include "vehicles/import/LoadVehicle.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <stdexcept>

#include "vehicles/import/SurfaceGuess.h"
#include "vehicles/models/Levels.h"

namespace vehicles {
namespace {

/// glTF: y up, +z forward, so +x is to the left. Vehicles: x forward, y left, z up.
glm::vec3 vehicleFromGltf(const glm::vec3& p) {
    return {p.z, p.x, p.y};
}

void addCorners(city::Mesh& mesh, const GltfTriangle& t, Surface surface, const glm::vec3& origin,
                float scale) {
    for (int k = 0; k < 3; ++k) {
        mesh.indices.push_back(static_cast<std::uint32_t>(mesh.vertices.size()));
        mesh.vertices.push_back({scale * (vehicleFromGltf(t.position[k]) - origin),
                                 vehicleFromGltf(t.normal[k]), glm::vec2(0),
                                 static_cast<std::uint32_t>(surface)});
    }
}

/// A node's triangles look like one wheel: round from the side, and on one side of the vehicle.
bool roundAndAside(const city::Aabb& wheel, const city::Aabb& whole) {
    const glm::vec3 s = wheel.size();
    return s.z > 0 && std::abs(s.x - s.z) < 0.25f * s.z && s.y < 0.45f * whole.size().y &&
           std::abs(wheel.centre().y - whole.centre().y) > 0.1f * whole.size().y;
}

}  // namespace

VehicleModel loadVehicle(const std::filesystem::path& file, float length) {
    return vehicleFrom(readGltf(file), file, length);
}

VehicleModel vehicleFrom(const GltfScene& scene, const std::filesystem::path& file, float length) {
    if (!(length > 0.1f && length < 200))
        throw std::runtime_error(file.string() + ": a vehicle of " + std::to_string(length) +
                                 " m cannot be made; ask for a length between 0.1 and 200 m");
    const std::vector<Surface> surfaces = guessSurfaces(scene);

    city::Aabb whole;
    std::map<int, city::Aabb> wheelBoxes;
    for (const GltfTriangle& t : scene.triangles)
        for (const glm::vec3& p : t.position) {
            const glm::vec3 q = vehicleFromGltf(p);
            whole.extend(q);
            if (const int node = scene.parts[static_cast<std::size_t>(t.part)].wheelNode; node >= 0)
                wheelBoxes[node].extend(q);
        }
    const glm::vec3 size = whole.size();
    const auto sane = [](float v) { return std::isfinite(v) && v > 1e-6f && v < 1e6f; };
    if (!sane(size.x) || !sane(size.y) || !sane(size.z) || size.y > 4 * size.x || size.z > 4 * size.x ||
        size.x > 100 * size.y)
        throw std::runtime_error(
            file.string() + ": the scene measures " + std::to_string(size.x) + " x " +
            std::to_string(size.y) + " x " + std::to_string(size.z) +
            " (length, width, height), which is no vehicle; export it with y up and +z forward");
    std::erase_if(wheelBoxes, [&](const auto& entry) { return !roundAndAside(entry.second, whole); });
    const bool turning = wheelBoxes.size() >= 2;
    if (!turning) wheelBoxes.clear();

    const float scale = length / size.x;
    glm::vec3 origin{whole.centre().x, whole.centre().y, whole.min.z};
    if (turning) {
        float front = -1e30f, rear = 1e30f;
        for (const auto& [node, box] : wheelBoxes) {
            front = std::max(front, box.centre().x);
            rear = std::min(rear, box.centre().x);
        }
        if (front - rear > 0.2f * size.x) origin.x = 0.5f * (front + rear);
    }

    VehicleModel model;
    model.name = file.stem().string();
    model.length = length;
    model.width = scale * size.y;
    model.height = scale * size.z;
    model.wheelRadius = 0.5f * scale * 0.45f * size.z;
    // The wheel that all others copy: the left one with most in front.
    int pattern = -1;
    for (const auto& [node, box] : wheelBoxes) {
        if (box.centre().y <= whole.centre().y) continue;
        if (pattern < 0 || box.centre().x > wheelBoxes[pattern].centre().x) pattern = node;
    }
    if (pattern < 0) wheelBoxes.clear();
    for (const auto& [node, box] : wheelBoxes) {
        const glm::vec3 centre = scale * (box.centre() - origin);
        model.wheels.push_back({centre, centre.x > 0, centre.y < 0});
    }
    if (pattern >= 0) model.wheelRadius = 0.5f * scale * wheelBoxes[pattern].size().z;
    model.levels.emplace_back();
    for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
        const GltfTriangle& t = scene.triangles[i];
        const int node = scene.parts[static_cast<std::size_t>(t.part)].wheelNode;
        if (!wheelBoxes.contains(node))
            addCorners(model.levels[0].body, t, surfaces[i], origin, scale);
        else if (node == pattern)
            addCorners(model.wheel, t, surfaces[i], wheelBoxes[pattern].centre(), scale);
    }
    if (model.levels[0].body.empty())
        throw std::runtime_error(file.string() +
                                 ": there is nothing but wheels in its scene; export the body with them");
    // Sharing equal corners is what a thickness of nothing does.
    model.levels[0].body = withoutThinPieces(model.levels[0].body, 0);
    model.wheel = withoutThinPieces(model.wheel, 0);
    makeLevels(model);
    return model;
}

}  // namespace vehicles
