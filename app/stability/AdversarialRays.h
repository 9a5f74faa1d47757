#pragma once

#include <glm/vec2.hpp>
#include <span>
#include <string>
#include <string_view>

#include "app/stability/SeededRandom.h"
#include "city/geometry/Ray.h"
#include "city/terrain/Heightfield.h"

namespace app::stability {

/// How a field's columns are made.
enum class Columns {
    town,       ///< streets, blocks, kerbs; single posts, empty, undefined and endless columns
    solidTown,  ///< the same without empty and endless columns: what triangles can stand for
    fineSteps,  ///< steps of 1e-6 m, and of one float
    allSteps,   ///< steps of 1e-6 to 1e4 m
    holes,      ///< more no-data than columns
    endless,    ///< a fifth of the columns have no top
    flat,       ///< one height: every ray that sinks meets a top, every other grazes
};

struct FieldKind {
    std::string_view name;
    int width = 0, height = 0;
    float cellSize = 1;  ///< metres
    glm::dvec2 origin{0};
    Columns columns = Columns::town;
};

/// The campaign's fields: cells of 0.05 to 100 m, up to 10^6 m from the origin.
std::span<const FieldKind> fieldKinds();
city::Heightfield makeField(const FieldKind& kind, SeededRandom& random);

/// Families of rays that are hard on grid walks.
enum class RayFamily {
    anywhere,
    alongEdges,
    throughCorners,
    nearCorners,
    grazingTops,
    grazingWalls,
    vertical,
    denormal,
    zeroComponents,
    onWalls,
    insideColumns,
    outside,
    farAway,
    onTops,
    slowAndFast,
    count
};
std::string_view nameOf(RayFamily family);

/// The start of a family's rays. Several rays from one start make a fan.
glm::vec3 startOf(RayFamily family, const city::Heightfield& field, SeededRandom& random);
/// A direction of the family from that start; never zero, always finite.
glm::vec3 directionOf(RayFamily family, const city::Heightfield& field, const glm::vec3& start,
                      SeededRandom& random);

/// A ray by which a row's first failure can be found again: every bit of it, its field, and the seed that
/// made that.
std::string described(const city::Ray& ray, std::string_view field, std::uint64_t seed);

}  // namespace app::stability
