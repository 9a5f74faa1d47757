#pragma once

#include "vehicles/models/VehicleModel.h"

namespace vehicles {

/// How the levels of detail are made: triangles of levels 1, 2 and 3; the last two carry the wheels.
struct LevelPlan {
    std::size_t triangles[3] = {2500, 700, 180};
};

/// Fills model.levels[1..] from levels[0] by meshoptimizer's quadric simplification; surfaces' borders are
/// kept as long as the target can be met with them, and small parts are dropped first. `plainWheel` (about 60
/// triangles, or empty) is what the last two levels carry in the wheels' places. Errors are measured: see
/// `distanceBetween`. All levels, and the wheel, come out ordered for the vertex cache. Cost: some tens of
/// milliseconds.
void makeLevels(VehicleModel& model, const city::Mesh& plainWheel, const LevelPlan& plan = {});

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
