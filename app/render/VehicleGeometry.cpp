#include "app/render/VehicleGeometry.h"

#include <algorithm>
#include <cstddef>
#include <map>

#include "app/frame/VehicleLevels.h"

namespace app {

VehicleGeometry::VehicleGeometry(std::span<const vehicles::VehicleModel> models) {
    std::vector<VehicleVertex> vertices;
    std::vector<std::uint32_t> indices;
    std::map<const city::Mesh*, std::int32_t> bases;  // levels may share vertices
    const auto add = [&](const VehicleLevels::Level& level) {
        const auto [base, isNew] =
            bases.try_emplace(level.vertices, static_cast<std::int32_t>(vertices.size()));
        constexpr auto last = static_cast<std::uint32_t>(vehicles::Surface::count) - 1;
        if (isNew)
            for (const city::Vertex& v : level.vertices->vertices)
                vertices.push_back({v.position, packNormal(v.normal), std::min(v.material, last)});
        const MeshRange range{static_cast<std::uint32_t>(indices.size()),
                              static_cast<std::uint32_t>(level.indices.size()), base->second};
        indices.insert(indices.end(), level.indices.begin(), level.indices.end());
        return range;
    };
    for (const vehicles::VehicleModel& model : models) {
        const VehicleLevels levels = vehicleLevels(model);
        Model m;
        for (const VehicleLevels::Level& level : levels.bodies)
            m.levels.push_back({add(level), level.wheelsInBody, level.error});
        for (const VehicleLevels::Level& level : levels.wheels)
            m.wheelLevels.push_back({add(level), level.error});
        m.wheels = levels.places;
        m.centre = levels.centre;
        m.halfSize = levels.halfSize;
        m.radius = levels.radius;
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
        .attribute(7, 1, 4, GL_FLOAT, false, offsetof(VehicleInstance, map))
        .indices(indices_.name());
}

}  // namespace app
