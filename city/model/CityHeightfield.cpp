#include "city/model/CityHeightfield.h"

#include <cmath>
#include <glm/common.hpp>
#include <stdexcept>

#include "city/terrain/Rasterise.h"

namespace city {

namespace {

constexpr float margin = 30;
constexpr double mostCells = 268435456.0;

Aabb transformed(const Aabb& box, const glm::mat4& m) {
    Aabb out;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::vec3 p((corner & 1) ? box.max.x : box.min.x, (corner & 2) ? box.max.y : box.min.y, (corner & 4) ? box.max.z : box.min.z);
        out.extend(glm::vec3(m * glm::vec4(p, 1)));
    }
    return out;
}

Aabb built(const CityModel& city) {
    Aabb box;
    for (const Chunk& chunk : city.chunks)
        if (chunk.kind != ChunkKind::ground) box.extend(chunk.bounds);
    std::vector<Aabb> prototypeBounds;
    for (const Prototype& p : city.prototypes) prototypeBounds.push_back(p.levels.empty() ? Aabb{} : p.levels.back().mesh.bounds());
    for (const Placement& p : city.placements)
        if (!prototypeBounds[p.prototype].empty()) box.extend(transformed(prototypeBounds[p.prototype], p.worldFromPrototype));
    for (const Lane& lane : city.roads.lanes)
        for (const glm::vec3& p : lane.centreLine) box.extend(p);
    if (box.empty()) return city.bounds;
    box.min -= glm::vec3(margin, margin, 0);
    box.max += glm::vec3(margin, margin, 0);
    if (!city.bounds.empty()) {
        box.min = glm::max(box.min, city.bounds.min);
        box.max = glm::min(box.max, city.bounds.max);
    }
    return box;
}

Heightfield fieldOver(const Aabb& box, float cellSize) {
    if (!std::isfinite(cellSize) || cellSize <= 0) throw std::invalid_argument("a heightfield's cell size must be finite and positive");
    if (box.empty()) return Heightfield(1, 1, cellSize, glm::dvec2(0));
    // On whole cells, so that cities built on a metre grid keep their walls on cell borders.
    const double x0 = std::floor(box.min.x / cellSize), x1 = std::ceil(box.max.x / cellSize);
    const double y0 = std::floor(box.min.y / cellSize), y1 = std::ceil(box.max.y / cellSize);
    const double width = std::max(1.0, x1 - x0), height = std::max(1.0, y1 - y0);
    if (!(width * height <= mostCells))
        throw std::invalid_argument("the heightfield's cells are too small for a city of this extent; ask for larger ones with --cell");
    return Heightfield(static_cast<int>(width), static_cast<int>(height), cellSize, glm::dvec2(x0, y0) * static_cast<double>(cellSize));
}

}  // namespace

Heightfield cityHeightfield(const CityModel& city, float cellSize) {
    Heightfield field = fieldOver(built(city), cellSize);
    for (const Chunk& chunk : city.chunks)
        if (chunk.kind != ChunkKind::furniture) rasterise(chunk.mesh, glm::mat4(1), Coverage::centre, field);
    for (const Placement& placement : city.placements) {
        const Prototype& prototype = city.prototypes[placement.prototype];
        if (prototype.inHeightfield && !prototype.levels.empty())
            rasterise(prototype.levels.front().mesh, placement.worldFromPrototype, Coverage::centre, field);
    }
    return field;
}

Heightfield occluderHeightfield(const CityModel& city, float cellSize) {
    Heightfield field = fieldOver(built(city), cellSize);
    for (const Chunk& chunk : city.chunks)
        if (chunk.kind == ChunkKind::building) rasterise(chunk.mesh, glm::mat4(1), Coverage::whole, field);
    return field;
}

}  // namespace city
