#pragma once

#include "city/generate/BoulevardPlan.h"
#include "city/generate/ChunkCollector.h"
#include "city/generate/CityPlants.h"

namespace city {

/// The houses that stand outside the ring street, wall to wall, so that every street that meets the ring ends
/// in a front; at the avenue's two ends a town hall and a church. Behind them yards out to the border.
void addEdgeRows(const BoulevardPlan& plan, const Palette& palette, const Standing& standing, Random& random,
                 CityModel& model, ChunkCollector& chunks);

}  // namespace city
