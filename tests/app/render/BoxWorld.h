#pragma once

#include <vector>

#include "city/model/CityModel.h"
#include "vehicles/models/VehicleModel.h"

namespace app::test {

/// A box with outward faces; texture coordinates in metres.
inline void addBox(city::Mesh& mesh, const glm::vec3& lo, const glm::vec3& hi, std::uint32_t material) {
    for (int axis = 0; axis < 3; ++axis) {
        for (int side = 0; side < 2; ++side) {
            const int u = (axis + 1) % 3;
            const int v = (axis + 2) % 3;
            glm::vec3 normal(0);
            normal[axis] = side == 1 ? 1.f : -1.f;
            const auto corner = [&](bool atU, bool atV) {
                glm::vec3 p;
                p[axis] = side == 1 ? hi[axis] : lo[axis];
                p[u] = atU ? hi[u] : lo[u];
                p[v] = atV ? hi[v] : lo[v];
                return city::Vertex{p, normal,
                                    axis == 2 ? glm::vec2(p.x, p.y) : glm::vec2(p[axis == 0 ? 1 : 0], p.z),
                                    material};
            };
            if (side == 1) {
                mesh.addQuad(corner(false, false), corner(true, false), corner(true, true),
                             corner(false, true));
            } else {
                mesh.addQuad(corner(false, false), corner(false, true), corner(true, true),
                             corner(true, false));
            }
        }
    }
}

inline city::Chunk chunkOf(city::ChunkKind kind, city::Mesh mesh) {
    city::Chunk chunk;
    chunk.kind = kind;
    chunk.bounds = mesh.bounds();
    chunk.mesh = std::move(mesh);
    return chunk;
}

/// Materials 0 ground (grey), 1 red, 2 green, 3 blue, 4 white; ground 400 m square, z = 0; a street along x
/// between two rows of boxes.
inline city::CityModel boxCity() {
    city::CityModel city;
    city.name = "boxes";
    for (const glm::vec3& tint : {glm::vec3(0.35f), glm::vec3(0.6f, 0.1f, 0.1f), glm::vec3(0.1f, 0.5f, 0.1f),
                                  glm::vec3(0.1f, 0.15f, 0.6f), glm::vec3(0.75f)}) {
        city::Material material;
        material.tint = tint;
        city.materials.push_back(material);
    }
    city::Mesh ground;
    const auto at = [](float x, float y) { return city::Vertex{{x, y, 0}, {0, 0, 1}, {x, y}, 0}; };
    ground.addQuad(at(-200, -200), at(200, -200), at(200, 200), at(-200, 200));
    city.chunks.push_back(chunkOf(city::ChunkKind::ground, std::move(ground)));
    for (int row = -4; row < 4; ++row) {
        for (int i = -6; i < 6; ++i) {
            city::Mesh mesh;
            const float x = 30.f * static_cast<float>(i);
            const float y = row < 0 ? 40.f * static_cast<float>(row) : 40.f * static_cast<float>(row) + 15;
            const float height = 8 + 4 * static_cast<float>((i * i + 3 * row * row + 7 * (i & 1)) % 5);
            addBox(mesh, {x, y, 0}, {x + 28, y + 25, height},
                   1 + static_cast<std::uint32_t>((i + row + 20) % 4));
            city.chunks.push_back(chunkOf(city::ChunkKind::building, std::move(mesh)));
        }
    }
    for (const city::Chunk& chunk : city.chunks) city.bounds.extend(chunk.bounds);
    return city;
}

/// A car of two boxes on four octagonal wheels.
inline vehicles::VehicleModel boxCar() {
    using vehicles::Surface;
    vehicles::VehicleModel car;
    car.name = "box car";
    vehicles::VehicleModel::Level level;
    addBox(level.body, {-2.2f, -0.9f, 0.3f}, {2.2f, 0.9f, 0.9f}, static_cast<std::uint32_t>(Surface::paint));
    addBox(level.body, {-1.5f, -0.8f, 0.9f}, {0.8f, 0.8f, 1.45f}, static_cast<std::uint32_t>(Surface::glass));
    car.levels.push_back(level);
    addBox(car.wheel, {-0.22f, -0.1f, -0.22f}, {0.22f, 0.1f, 0.22f},
           static_cast<std::uint32_t>(Surface::tyre));
    for (float x : {-1.3f, 1.3f})
        for (float y : {-0.85f, 0.85f}) car.wheels.push_back({{x, y, 0.32f}, x > 0, y < 0});
    return car;
}

}  // namespace app::test
