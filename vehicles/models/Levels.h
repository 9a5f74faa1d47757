#pragma once

#include "vehicles/models/VehicleModel.h"

namespace vehicles {

/// How the levels of detail are made: triangles of levels 1, 2 and 3; the last two carry the wheels.
struct LevelPlan {
    std::size_t triangles[3] = {2500, 700, 180};
};

/// Fills model.levels[1..] from levels[0]: thin pieces of surface (gaps, seals) take their neighbours'
/// surface, small separate parts are dropped, and the rest goes through meshoptimizer's quadric
/// simplification, which keeps the borders of surfaces but in the last level. The last two levels carry plain
/// wheels. Errors are measured (`distanceBetween`) and never fall from level to level; a level that would not
/// be smaller than the one before is left out. All levels, and the wheel, come out ordered for the vertex
/// cache. An empty body is left as it is. Cost: some tens of milliseconds.
void makeLevels(VehicleModel& model, const LevelPlan& plan = {});

/// The mesh with every connected piece of one surface that is thinner than `thickness` metres (twice its area
/// over its outline) painted like the neighbour with which it shares the longest border, vertices shared
/// anew.
city::Mesh withoutThinPieces(const city::Mesh& mesh, float thickness);

/// The largest distance in metres from points spread over `reference` (vertices and middles of triangles,
/// about `samples`; surface `interior` is left out, since it is not seen) to the nearest point of `mesh`: a
/// one-sided Hausdorff distance, from below. Infinite if `mesh` is empty, zero if `reference` is. Cost:
/// samples times triangles.
float distanceBetween(const city::Mesh& reference, const city::Mesh& mesh, std::size_t samples = 1200);

/// The model's body with its wheels in place, as far levels carry them.
city::Mesh withWheels(const city::Mesh& body, const VehicleModel& model, const city::Mesh& wheel);

/// Orders triangles and vertices for the caches (meshoptimizer); the surface stays the same.
void optimise(city::Mesh& mesh);

}  // namespace vehicles
