#include "app/render/CityGeometry.h"

#include <algorithm>
#include <cstddef>
#include <glm/geometric.hpp>

namespace app {

namespace {

/// Gathers meshes into one vertex and one index list, triangles sorted by how they are drawn.
class Collector {
  public:
    explicit Collector(const std::vector<city::Material>& materials) : materials_(materials) {}

    CityGeometry::Ranges add(const city::Mesh& mesh) {
        CityGeometry::Ranges ranges;
        const auto baseVertex = static_cast<std::int32_t>(vertices.size());
        for (const city::Vertex& v : mesh.vertices) {
            const auto material = static_cast<std::uint16_t>(std::min<std::uint32_t>(v.material, 0xffffu));
            vertices.push_back({v.position, v.texcoord, packNormal(v.normal), material, 0xffffu});
        }
        for (std::size_t coverage = 0; coverage < coverageCount; ++coverage) {
            MeshRange& range = ranges[coverage];
            range.firstIndex = static_cast<std::uint32_t>(indices.size());
            range.baseVertex = baseVertex;
            for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
                const std::uint32_t* corner = &mesh.indices[i];
                if (static_cast<std::size_t>(coverageOf(mesh.vertices[corner[0]].material)) != coverage)
                    continue;
                indices.insert(indices.end(), corner, corner + 3);
            }
            range.indexCount = static_cast<std::uint32_t>(indices.size()) - range.firstIndex;
        }
        return ranges;
    }

    std::vector<CityVertex> vertices;
    std::vector<std::uint32_t> indices;

  private:
    Coverage coverageOf(std::uint32_t material) const {
        if (material >= materials_.size()) return Coverage::solid;
        const city::Material& m = materials_[material];
        return m.cutout ? Coverage::cutout : m.twoSided ? Coverage::twoSided : Coverage::solid;
    }
    const std::vector<city::Material>& materials_;
};

void describe(reflection::gl::VertexArray& array, GLuint vertices, GLuint indices) {
    array.buffer(0, vertices, sizeof(CityVertex))
        .attribute(0, 0, 3, GL_FLOAT, false, offsetof(CityVertex, position))
        .attribute(1, 0, 2, GL_FLOAT, false, offsetof(CityVertex, texcoord))
        .attribute(2, 0, 4, GL_INT_2_10_10_10_REV, true, offsetof(CityVertex, normal))
        .integerAttribute(3, 0, 1, GL_UNSIGNED_SHORT, offsetof(CityVertex, material))
        .attribute(4, 0, 1, GL_UNSIGNED_SHORT, true, offsetof(CityVertex, open))
        .indices(indices);
}

}  // namespace

CityGeometry::CityGeometry(const city::CityModel& city) {
    Collector collector(city.materials);
    for (const city::Chunk& chunk : city.chunks) {
        if (chunk.mesh.empty()) continue;
        Chunk c;
        c.bounds = chunk.mesh.bounds();
        c.kind = chunk.kind;
        c.ranges = collector.add(chunk.mesh);
        bounds_.extend(c.bounds);
        chunks_.push_back(c);
    }
    for (const city::StandingReflector& reflector : city.reflectors) {
        city::Mesh mesh = city::reflectorMesh(reflector, 3);
        if (mesh.empty()) continue;
        for (city::Vertex& v : mesh.vertices) v.position += reflector.foot;
        Chunk c;
        c.bounds = mesh.bounds();
        c.kind = city::ChunkKind::furniture;
        c.ranges = collector.add(mesh);
        c.onlyShadow = true;
        bounds_.extend(c.bounds);
        chunks_.push_back(c);
    }
    for (const city::Prototype& prototype : city.prototypes) {
        Prototype p;
        city::Aabb box;
        for (const city::Prototype::Level& level : prototype.levels) {
            box.extend(level.mesh.bounds());
            p.levels.push_back({collector.add(level.mesh), level.error});
        }
        p.bounds = box;
        if (!box.empty()) {
            p.centre = box.centre();
            for (const city::Prototype::Level& level : prototype.levels)
                for (const city::Vertex& v : level.mesh.vertices)
                    p.radius = std::max(p.radius, glm::length(v.position - p.centre));
        }
        prototypes_.push_back(std::move(p));
    }
    for (const city::Placement& placement : city.placements) {
        if (placement.prototype >= prototypes_.size() || prototypes_[placement.prototype].levels.empty())
            continue;
        const Prototype& prototype = prototypes_[placement.prototype];
        const glm::mat4& m = placement.worldFromPrototype;
        Placement p;
        p.prototype = placement.prototype;
        p.instance = {glm::vec4(m[0].x, m[1].x, m[2].x, m[3].x), glm::vec4(m[0].y, m[1].y, m[2].y, m[3].y),
                      glm::vec4(m[0].z, m[1].z, m[2].z, m[3].z)};
        p.scale = std::max(
            {glm::length(glm::vec3(m[0])), glm::length(glm::vec3(m[1])), glm::length(glm::vec3(m[2]))});
        p.centre = glm::vec3(m * glm::vec4(prototype.centre, 1));
        p.radius = prototype.radius * p.scale;
        for (int corner = 0; corner < 8; ++corner) {
            const city::Aabb& b = prototype.bounds;
            p.bounds.extend(glm::vec3(m * glm::vec4((corner & 1) != 0 ? b.max.x : b.min.x,
                                                    (corner & 2) != 0 ? b.max.y : b.min.y,
                                                    (corner & 4) != 0 ? b.max.z : b.min.z, 1)));
        }
        bounds_.extend(p.bounds);
        placements_.push_back(p);
    }

    using namespace reflection::gl;
    vertices_ = Buffer::filled(std::span<const CityVertex>(collector.vertices));
    indices_ = Buffer::filled(std::span<const std::uint32_t>(collector.indices));
    instances_ = Buffer::create();
    chunkArray_ = VertexArray::create();
    describe(chunkArray_, vertices_.name(), indices_.name());
    instancedArray_ = VertexArray::create();
    describe(instancedArray_, vertices_.name(), indices_.name());
    instancedArray_.buffer(1, instances_.name(), sizeof(PlacementInstance), 1)
        .attribute(5, 1, 4, GL_FLOAT, false, offsetof(PlacementInstance, row0))
        .attribute(6, 1, 4, GL_FLOAT, false, offsetof(PlacementInstance, row1))
        .attribute(7, 1, 4, GL_FLOAT, false, offsetof(PlacementInstance, row2));
}

}  // namespace app
