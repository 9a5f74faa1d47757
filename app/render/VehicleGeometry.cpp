#include "app/render/VehicleGeometry.h"

#include <algorithm>
#include <cstddef>
#include <glm/geometric.hpp>

namespace app {

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
    for (const vehicles::VehicleModel& model : models) {
        Model m;
        city::Aabb box;
        for (const vehicles::VehicleModel::Level& level : model.levels) {
            m.levels.push_back({add(level.body), level.wheelsInBody, level.error});
            box.extend(level.body.bounds());
        }
        m.wheel = add(model.wheel);
        m.wheels = model.wheels;
        // A steered wheel may stick out of the body: its bounding sphere in any position.
        float wheelRadius = 0;
        for (const city::Vertex& v : model.wheel.vertices)
            wheelRadius = std::max(wheelRadius, glm::length(v.position));
        if (!m.wheel.empty()) {
            for (const auto& wheel : model.wheels) {
                box.extend(wheel.centre - glm::vec3(wheelRadius));
                box.extend(wheel.centre + glm::vec3(wheelRadius));
            }
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
