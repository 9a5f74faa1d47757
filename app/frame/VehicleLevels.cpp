#include "app/frame/VehicleLevels.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace app {

namespace {

/// Fewer triangles over the same vertices; `error`: metres by which they may be off. Keeps borders and seams
/// unless sloppy.
std::vector<std::uint32_t> simplified(const city::Mesh& mesh, std::size_t triangles, bool sloppy,
                                      float& error) {
    std::vector<std::uint32_t> indices(mesh.indices.size());
    const float* positions = &mesh.vertices[0].position.x;
    const std::size_t target = std::min(triangles * 3, indices.size());
    float relative = 0;
    const std::size_t count =
        sloppy ? meshopt_simplifySloppy(indices.data(), mesh.indices.data(), mesh.indices.size(), positions,
                                        mesh.vertices.size(), sizeof(city::Vertex), target, 1.0f, &relative)
               : meshopt_simplify(indices.data(), mesh.indices.data(), mesh.indices.size(), positions,
                                  mesh.vertices.size(), sizeof(city::Vertex), target, 1.0f, 0, &relative);
    indices.resize(count);
    error = relative * meshopt_simplifyScale(positions, mesh.vertices.size(), sizeof(city::Vertex));
    return indices;
}

glm::mat3 aboutY(double angle) {
    const auto c = static_cast<float>(std::cos(angle));
    const auto s = static_cast<float>(std::sin(angle));
    return glm::mat3(c, 0, -s, 0, 1, 0, s, 0, c);
}

glm::mat3 aboutZ(double angle) {
    const auto c = static_cast<float>(std::cos(angle));
    const auto s = static_cast<float>(std::sin(angle));
    return glm::mat3(c, s, 0, -s, c, 0, 0, 0, 1);
}

}  // namespace

std::size_t VehicleLevels::choose(const std::vector<Level>& levels, float allowed) {
    std::size_t level = 0;
    while (level + 1 < levels.size() && levels[level + 1].error <= allowed) ++level;
    return level;
}

glm::mat3 vehicleFromWheel(const vehicles::VehicleModel::Wheel& wheel, const vehicles::VehiclePose& pose) {
    glm::mat3 turn = aboutY(pose.wheelAngle);
    if (wheel.steered) turn = aboutZ(pose.steering) * turn;
    if (wheel.mirrored) turn = turn * aboutZ(std::numbers::pi);
    return turn;
}

VehicleLevels vehicleLevels(const vehicles::VehicleModel& model) {
    VehicleLevels m;
    city::Aabb box;
    for (std::size_t i = 0; i < model.levels.size(); ++i) {
        const vehicles::VehicleModel::Level& level = model.levels[i];
        m.bodies.push_back({&level.body, level.body.indices, level.wheelsInBody, level.error});
        box.extend(level.body.bounds());
        if (i + 1 == model.levels.size()) break;
        const double fine = static_cast<double>(level.body.triangleCount());
        const double next = static_cast<double>(model.levels[i + 1].body.triangleCount());
        if (next * 4 >= fine) continue;
        float error = 0;
        std::vector<std::uint32_t> between =
            simplified(level.body, static_cast<std::size_t>(std::sqrt(fine * next)), false, error);
        if (level.error + error < model.levels[i + 1].error)
            m.bodies.push_back({&level.body, std::move(between), level.wheelsInBody, level.error + error});
    }
    if (!model.wheel.empty()) {
        m.wheels.push_back({&model.wheel, model.wheel.indices, false, 0});
        for (std::size_t triangles : {700u, 250u, 90u}) {
            float error = 0;
            std::vector<std::uint32_t> coarse = simplified(model.wheel, triangles, triangles < 500, error);
            if (coarse.size() >= 40 * 3 && coarse.size() < m.wheels.back().indices.size() / 3 * 2)
                m.wheels.push_back({&model.wheel, std::move(coarse), false, error});
        }
    }
    m.places = model.wheels;
    // A steered wheel may stick out of the body: its bounding sphere in any position.
    float wheelRadius = 0;
    for (const city::Vertex& v : model.wheel.vertices)
        wheelRadius = std::max(wheelRadius, glm::length(v.position));
    for (const auto& wheel : model.wheels) {
        if (model.wheel.empty()) break;
        box.extend(wheel.centre - glm::vec3(wheelRadius));
        box.extend(wheel.centre + glm::vec3(wheelRadius));
    }
    if (!box.empty()) {
        m.centre = box.centre();
        m.halfSize = 0.5f * box.size();
        m.radius = glm::length(m.halfSize);
    }
    return m;
}

}  // namespace app
