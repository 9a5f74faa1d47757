#include "app/render/VehicleGeometry.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>

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

}  // namespace

VehicleGeometry::VehicleGeometry(std::span<const vehicles::VehicleModel> models) {
    std::vector<VehicleVertex> vertices;
    std::vector<std::uint32_t> indices;
    const auto add = [&](const city::Mesh& mesh) {
        const MeshRange range{static_cast<std::uint32_t>(indices.size()),
                              static_cast<std::uint32_t>(mesh.indices.size()),
                              static_cast<std::int32_t>(vertices.size())};
        constexpr auto last = static_cast<std::uint32_t>(vehicles::Surface::count) - 1;
        for (const city::Vertex& v : mesh.vertices)
            vertices.push_back({v.position, packNormal(v.normal), std::min(v.material, last)});
        indices.insert(indices.end(), mesh.indices.begin(), mesh.indices.end());
        return range;
    };
    const auto addCoarser = [&](const city::Mesh& mesh, const MeshRange& fine, std::size_t triangles,
                                bool sloppy, float& error) {
        const std::vector<std::uint32_t> coarse = simplified(mesh, triangles, sloppy, error);
        const MeshRange range{static_cast<std::uint32_t>(indices.size()),
                              static_cast<std::uint32_t>(coarse.size()), fine.baseVertex};
        indices.insert(indices.end(), coarse.begin(), coarse.end());
        return range;
    };
    for (const vehicles::VehicleModel& model : models) {
        Model m;
        city::Aabb box;
        for (std::size_t i = 0; i < model.levels.size(); ++i) {
            const vehicles::VehicleModel::Level& level = model.levels[i];
            m.levels.push_back({add(level.body), level.wheelsInBody, level.error});
            box.extend(level.body.bounds());
            if (i + 1 == model.levels.size()) break;
            const double fine = static_cast<double>(level.body.triangleCount());
            const double next = static_cast<double>(model.levels[i + 1].body.triangleCount());
            if (next * 4 >= fine) continue;
            float error = 0;
            const MeshRange between =
                addCoarser(level.body, m.levels.back().body, static_cast<std::size_t>(std::sqrt(fine * next)),
                           false, error);
            if (level.error + error < model.levels[i + 1].error)
                m.levels.push_back({between, level.wheelsInBody, level.error + error});
        }
        if (!model.wheel.empty()) {
            m.wheelLevels.push_back({add(model.wheel), 0});
            for (std::size_t triangles : {700u, 250u, 90u}) {
                float error = 0;
                const MeshRange coarse =
                    addCoarser(model.wheel, m.wheelLevels.front().mesh, triangles, triangles < 500, error);
                if (coarse.indexCount >= 40 * 3 &&
                    coarse.indexCount < m.wheelLevels.back().mesh.indexCount / 3 * 2)
                    m.wheelLevels.push_back({coarse, error});
            }
        }
        m.wheels = model.wheels;
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
        models_.push_back(std::move(m));
    }

    using namespace reflection::gl;
    vertices_ = Buffer::filled(std::span<const VehicleVertex>(vertices));
    indices_ = Buffer::filled(std::span<const std::uint32_t>(indices));
    instances_ = Buffer::create();
    array_ = VertexArray::create();
    array_.buffer(0, vertices_.name(), sizeof(VehicleVertex))
        .attribute(0, 0, 3, GL_FLOAT, false, offsetof(VehicleVertex, position))
        .attribute(1, 0, 4, GL_INT_2_10_10_10_REV, true, offsetof(VehicleVertex, normal))
        .integerAttribute(2, 0, 1, GL_UNSIGNED_INT, offsetof(VehicleVertex, surface))
        .buffer(1, instances_.name(), sizeof(VehicleInstance), 1)
        .attribute(3, 1, 4, GL_FLOAT, false, offsetof(VehicleInstance, row0))
        .attribute(4, 1, 4, GL_FLOAT, false, offsetof(VehicleInstance, row1))
        .attribute(5, 1, 4, GL_FLOAT, false, offsetof(VehicleInstance, row2))
        .attribute(6, 1, 4, GL_FLOAT, false, offsetof(VehicleInstance, paint))
        .attribute(7, 1, 1, GL_FLOAT, false, offsetof(VehicleInstance, mapLayer))
        .indices(indices_.name());
}

}  // namespace app
