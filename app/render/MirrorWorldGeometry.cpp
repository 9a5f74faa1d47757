#include "app/render/MirrorWorldGeometry.h"

#include <span>

#include "app/mirrors/LitShapes.h"

namespace app {

namespace {

/// Fewer triangles than this are drawn or left out as one.
constexpr std::size_t leastClustered = 64;

glm::vec3 withoutMap(const glm::vec3& tint, const glm::vec3& reflectance, const glm::vec3& beyond) {
    return tint * (1.f - reflectance) + reflectance * beyond;
}

LitMesh meshOf(const MirrorWorld::Flat& flat, const glm::vec3& colour) {
    LitMesh mesh;
    for (const glm::dvec3& c : flat.mirror.plane.corners())
        mesh.corners.push_back({glm::vec3(c), glm::vec3(flat.mirror.plane.normal()), colour});
    for (std::uint32_t i = 2; i < mesh.corners.size(); ++i)
        mesh.indices.insert(mesh.indices.end(), {0, i - 1, i});
    return mesh;
}

}  // namespace

MirrorWorldGeometry::MirrorWorldGeometry(const MirrorWorld& world, float longest) {
    std::vector<LitMesh::Corner> corners;
    std::vector<std::uint32_t> all;
    const auto keep = [&](const LitMesh& given) {
        LitMesh mesh = longest > 0 ? subdivided(given, longest) : given;
        Range range{all.size(), mesh.indices.size(), {}};
        if (mesh.triangles() >= leastClustered) range.clusters = clusterTriangles(mesh);
        for (TriangleCluster& c : range.clusters) c.first += range.first;
        const auto base = static_cast<std::uint32_t>(corners.size());
        corners.insert(corners.end(), mesh.corners.begin(), mesh.corners.end());
        for (std::uint32_t i : mesh.indices) all.push_back(base + i);
        return range;
    };
    for (const LitMesh& m : world.objects) objects.push_back(keep(m));
    for (const MirrorWorld::Flat& f : world.mirrors)
        mirrors.push_back(
            keep(meshOf(f, withoutMap(f.tint, f.mirror.plane.surface().reflectance, world.beyond))));
    for (const MirrorWorld::Curved& c : world.curved) {
        LitMesh mesh = c.mesh;
        for (LitMesh::Corner& corner : mesh.corners)
            corner.colour = withoutMap(c.tint, c.reflector.surface.reflectance, world.beyond);
        curved.push_back(keep(mesh));
    }
    vertices_ = reflection::gl::Buffer::filled(std::span<const LitMesh::Corner>(corners));
    indices_ = reflection::gl::Buffer::filled(std::span<const std::uint32_t>(all));
    array_ = reflection::gl::VertexArray::create();
    array_.buffer(0, vertices_.name(), sizeof(LitMesh::Corner))
        .attribute(0, 0, 3, GL_FLOAT, false, offsetof(LitMesh::Corner, position))
        .attribute(1, 0, 3, GL_FLOAT, false, offsetof(LitMesh::Corner, normal))
        .attribute(2, 0, 3, GL_FLOAT, false, offsetof(LitMesh::Corner, colour))
        .indices(indices_.name());
}

void MirrorDrawList::clear() {
    counts_.clear();
    offsets_.clear();
    end_ = 0;
}

void MirrorDrawList::addPart(std::size_t first, std::size_t count) {
    triangles_ += count / 3;
    // Neighbours in the buffer are one draw: each costs a software rasteriser microseconds.
    if (!counts_.empty() && first == end_) {
        counts_.back() += static_cast<GLsizei>(count);
    } else {
        counts_.push_back(static_cast<GLsizei>(count));
        offsets_.push_back(reinterpret_cast<const void*>(first * sizeof(std::uint32_t)));
    }
    end_ = first + count;
}

void MirrorDrawList::addSeen(const MirrorWorldGeometry::Range& range, const glm::dvec3& eye,
                             const reflection::HalfSpaces& frustum) {
    if (range.clusters.empty() || frustum.empty()) {
        add(range);
        return;
    }
    for (const TriangleCluster& c : range.clusters)
        if (mayBeSeen(c, eye, frustum)) addPart(c.first, c.count);
}

void MirrorDrawList::draw() {
    if (!counts_.empty())
        glMultiDrawElements(GL_TRIANGLES, counts_.data(), GL_UNSIGNED_INT, offsets_.data(),
                            static_cast<GLsizei>(counts_.size()));
    clear();
}

}  // namespace app
