#include "city/model/CityHeightfield.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <stdexcept>
#include <utility>

#include "city/model/LaneClearance.h"
#include "city/terrain/Rasterise.h"

namespace city {

namespace {

constexpr float nothing = -std::numeric_limits<float>::infinity();
constexpr float margin = 30;
constexpr double mostCells = 268435456.0;

/// Metres beside a lane over which crowns hang without standing there: the width of a parking strip. Mean
/// FLIP of a car 10 m away with crowns as columns everywhere, and none within 0, 1.5, 2, 2.5, 4 m of lanes:
/// Helsinki 0.118, 0.085 0.084 0.084 0.075 0.082; boulevard 0.089, 0.089 0.075 0.075 0.093 0.094 (there the
/// trees themselves stand 3 m from lanes).
constexpr float crownClearance = 2;

constexpr float leastAir = 1.5f;   ///< metres under a crown that hangs: a car has room beneath
constexpr float lanesFree = 3.0f;  ///< metres under crowns over lanes

Aabb transformed(const Aabb& box, const glm::mat4& m) {
    Aabb out;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::vec3 p((corner & 1) ? box.max.x : box.min.x, (corner & 2) ? box.max.y : box.min.y,
                          (corner & 4) ? box.max.z : box.min.z);
        out.extend(glm::vec3(m * glm::vec4(p, 1)));
    }
    return out;
}

Aabb built(const CityModel& city) {
    Aabb box;
    for (const Chunk& chunk : city.chunks)
        if (chunk.kind != ChunkKind::ground) box.extend(chunk.bounds);
    std::vector<Aabb> prototypeBounds;
    for (const Prototype& p : city.prototypes)
        prototypeBounds.push_back(p.levels.empty() ? Aabb{} : p.levels.back().mesh.bounds());
    for (const Placement& p : city.placements)
        if (p.prototype < prototypeBounds.size() && !prototypeBounds[p.prototype].empty())
            box.extend(transformed(prototypeBounds[p.prototype], p.worldFromPrototype));
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
    if (!std::isfinite(cellSize) || cellSize <= 0)
        throw std::invalid_argument("a heightfield's cell size must be finite and positive");
    if (box.empty()) return Heightfield(1, 1, cellSize, glm::dvec2(0));
    // On whole cells, so that cities built on a metre grid keep their walls on cell borders.
    const double x0 = std::floor(box.min.x / cellSize), x1 = std::ceil(box.max.x / cellSize);
    const double y0 = std::floor(box.min.y / cellSize), y1 = std::ceil(box.max.y / cellSize);
    const double width = std::max(1.0, x1 - x0), height = std::max(1.0, y1 - y0);
    if (!(width * height <= mostCells))
        throw std::invalid_argument(
            "the heightfield's cells are too small for a city of this extent; ask for larger ones with "
            "--cell");
    return Heightfield(static_cast<int>(width), static_cast<int>(height), cellSize,
                       glm::dvec2(x0, y0) * static_cast<double>(cellSize));
}

/// Of each field, the highest (or lowest) of the 3 x 3 cells around; cells past the border do not count.
template <class Choose>
Heightfield overNeighbours(const Heightfield& field, float start, Choose choose) {
    Heightfield result = field;
    for (int j = 0; j < field.height(); ++j)
        for (int i = 0; i < field.width(); ++i) {
            float value = start;
            for (int v = std::max(0, j - 1); v <= std::min(field.height() - 1, j + 1); ++v)
                for (int u = std::max(0, i - 1); u <= std::min(field.width() - 1, i + 1); ++u)
                    value = choose(value, field.at(u, v));
            result.set(i, j, value);
        }
    return result;
}

void raiseTo(Heightfield& field, const Heightfield& other) {
    for (std::size_t k = 0; k < field.cells().size(); ++k)
        field.cells()[k] = std::max(field.cells()[k], other.cells()[k]);
}

/// Height at which a 2 x 2 block around each cell stands: thin things have none.
Heightfield thickPart(const Heightfield& field) {
    Heightfield result(field.width(), field.height(), field.cellSize(), field.origin());
    for (int j = 0; j + 1 < field.height(); ++j)
        for (int i = 0; i + 1 < field.width(); ++i) {
            const float z = std::min(std::min(field.at(i, j), field.at(i + 1, j)),
                                     std::min(field.at(i, j + 1), field.at(i + 1, j + 1)));
            for (int v = j; v <= j + 1; ++v)
                for (int u = i; u <= i + 1; ++u) result.set(u, v, std::max(result.at(u, v), z));
        }
    return result;
}

/// Raises cells in which a part of a building stands that the sampling at centres lost. `centres` has the
/// centres' heights, `any` the highest point in each cell. Along an ordinary facade `any` is one cell too
/// wide as well: there the building itself stands, in a thick part, beside the cell, and the cell is left
/// alone.
void keepThinWalls(const Heightfield& centres, const Heightfield& any, Heightfield& field) {
    const Heightfield beside =
        overNeighbours(thickPart(centres), nothing, [](float a, float b) { return std::max(a, b); });
    // Under a pitched roof the part beside may be lower by a cell's rise.
    const float rise = field.cellSize();
    for (std::size_t k = 0; k < field.cells().size(); ++k) {
        const float z = any.cells()[k];
        if (z > field.cells()[k] && !(beside.cells()[k] >= z - rise)) field.cells()[k] = z;
    }
}

/// The coarsest level that differs from the finest by less than a quarter of a cell.
const Mesh* levelFor(const Prototype& prototype, float scale, float cellSize) {
    const Mesh* chosen = nullptr;
    for (const Prototype::Level& level : prototype.levels)
        if (chosen == nullptr || level.error * scale <= 0.25f * cellSize) chosen = &level.mesh;
    return chosen;
}

Heightfield emptyLike(const Heightfield& field) {
    return Heightfield(field.width(), field.height(), field.cellSize(), field.origin());
}

/// The city before its parts are put together.
struct Layers {
    Heightfield ground, buildings, touched;
    Heightfield crowns;        ///< tops, gaps between leaves filled
    Heightfield lowestLeaves;  ///< their lowest points, upside down: -z
};

Layers layersOf(const CityModel& city, float cellSize) {
    const Heightfield empty = fieldOver(built(city), cellSize);
    Layers layers{empty, empty, empty, empty, empty};
    const glm::mat4 identity(1);
    for (const Chunk& chunk : city.chunks) {
        if (chunk.kind == ChunkKind::building) {
            rasterise(chunk.mesh, identity, Coverage::centre, layers.buildings);
            rasterise(chunk.mesh, identity, Coverage::any, layers.touched);
        } else if (chunk.kind == ChunkKind::ground) {
            rasterise(chunk.mesh, identity, Coverage::centre, layers.ground);
        }
    }
    glm::mat4 upsideDown(1);
    upsideDown[2][2] = -1;
    for (const Placement& placement : city.placements) {
        if (placement.prototype >= city.prototypes.size()) continue;
        const Prototype& prototype = city.prototypes[placement.prototype];
        if (!prototype.inHeightfield) continue;
        const glm::mat4& m = placement.worldFromPrototype;
        const float scale = std::max(
            {glm::length(glm::vec3(m[0])), glm::length(glm::vec3(m[1])), glm::length(glm::vec3(m[2]))});
        if (const Mesh* mesh = levelFor(prototype, scale, cellSize)) {
            rasterise(*mesh, m, Coverage::centre, layers.crowns);
            rasterise(*mesh, upsideDown * m, Coverage::centre, layers.lowestLeaves);
        }
    }
    clearLanes(city.roads, 0, layers.buildings);
    clearLanes(city.roads, 0, layers.touched);
    // Closing: gaps between leaves fill up, the crown's outline stays.
    if (!city.placements.empty()) {
        const Heightfield grown =
            overNeighbours(layers.crowns, nothing, [](float a, float b) { return std::max(a, b); });
        layers.crowns = overNeighbours(grown, std::numeric_limits<float>::infinity(),
                                       [](float a, float b) { return std::min(a, b); });
    }
    return layers;
}

void addBuildings(Layers& layers) {
    raiseTo(layers.ground, layers.buildings);
    keepThinWalls(layers.buildings, layers.touched, layers.ground);
}

/// Heights of the lowest leaves, each the median of those in the 3 x 3 cells around: a trunk, or one leaf
/// that droops, does not count.
Heightfield undersidesOf(const Heightfield& upsideDown) {
    Heightfield result = emptyLike(upsideDown);
    std::array<float, 9> around;
    for (int j = 0; j < upsideDown.height(); ++j)
        for (int i = 0; i < upsideDown.width(); ++i) {
            std::size_t n = 0;
            for (int v = std::max(0, j - 1); v <= std::min(upsideDown.height() - 1, j + 1); ++v)
                for (int u = std::max(0, i - 1); u <= std::min(upsideDown.width() - 1, i + 1); ++u)
                    if (const float z = upsideDown.at(u, v); std::isfinite(z)) around[n++] = -z;
            if (n == 0) continue;
            const auto middle = around.begin() + static_cast<std::ptrdiff_t>(n / 2);
            std::nth_element(around.begin(), middle, around.begin() + static_cast<std::ptrdiff_t>(n));
            result.set(i, j, *middle);
        }
    return result;
}

}  // namespace

Heightfield cityHeightfield(const CityModel& city, float cellSize) {
    Layers layers = layersOf(city, cellSize);
    clearLanes(city.roads, crownClearance, layers.crowns);
    raiseTo(layers.ground, layers.crowns);
    addBuildings(layers);
    return std::move(layers.ground);
}

CityColumns cityColumns(const CityModel& city, float cellSize) {
    Layers layers = layersOf(city, cellSize);
    const Heightfield undersides = undersidesOf(layers.lowestLeaves);
    Heightfield kept = layers.crowns;  // without the lanes' share: what stands there is no bush
    clearLanes(city.roads, crownClearance, kept);
    Overhang hanging{emptyLike(layers.ground), emptyLike(layers.ground)};
    for (int j = 0; j < kept.height(); ++j)
        for (int i = 0; i < kept.width(); ++i) {
            const float top = layers.crowns.at(i, j), ground = layers.ground.at(i, j);
            if (!std::isfinite(top)) continue;
            const bool overLane = kept.at(i, j) == nothing;
            float underside = undersides.at(i, j);
            if (overLane && std::isfinite(ground)) underside = std::max(underside, ground + lanesFree);
            if (std::isfinite(underside) && !(underside - ground < leastAir)) {
                hanging.underside.set(i, j, underside);
                hanging.top.set(i, j, top);
                kept.set(i, j, nothing);
            }
        }
    raiseTo(layers.ground, kept);
    addBuildings(layers);
    return {std::move(layers.ground), std::move(hanging)};
}

Heightfield occluderHeightfield(const CityModel& city, float cellSize) {
    Heightfield field = fieldOver(built(city), cellSize);
    // Chunk by chunk: a cell that two chunks cover only together stays empty, which errs on the safe side.
    for (const Chunk& chunk : city.chunks)
        if (chunk.kind == ChunkKind::building) rasterise(chunk.mesh, glm::mat4(1), Coverage::whole, field);
    return field;
}

}  // namespace city
