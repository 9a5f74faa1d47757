#pragma once

#include <cstdint>
#include <vector>

#include "city/generate/CityPlants.h"
#include "city/import/OsmData.h"
#include "city/import/OsmGround.h"
#include "city/model/CityModel.h"

namespace city {

struct FurnitureCounts {
    std::size_t trees = 0;      ///< mapped one by one
    std::size_t rowTrees = 0;   ///< set along tree rows
    std::size_t woodTrees = 0;  ///< strewn in woods
    std::size_t lamps = 0;
    std::size_t others = 0;  ///< benches, bins, bollards, advertising columns
};

/// Adds placements of trees, lamps and small things (`kinds`: their prototypes in the model), turned
/// towards the nearest street where they have a front. Trees strewn in woods keep out of buildings, streets
/// and paths.
FurnitureCounts placeFurniture(const OsmData& data, const StreetGraph& streets, const GroundPlan& ground,
                               const std::vector<Footprint>& buildings, const Standing& kinds,
                               std::uint64_t seed, CityModel& model);

}  // namespace city
