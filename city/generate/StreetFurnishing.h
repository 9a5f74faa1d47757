#pragma once

#include "city/generate/BoulevardPlan.h"
#include "city/generate/ChunkCollector.h"
#include "city/generate/CityPlants.h"

namespace city {

/// Height of pavements above the carriageway, metres: as the street surfaces are built.
inline constexpr float pavementHeight = 0.12f;

/// Trees, lamps, benches, bins, masts and bollards along every street of the plan, clear of lanes and
/// crossings. Trees stand back far enough for their crowns to stay off the lanes.
void furnishStreets(const BoulevardPlan& plan, const Palette& palette, const Standing& standing,
                    Random& random, CityModel& model, ChunkCollector& chunks);

}  // namespace city
