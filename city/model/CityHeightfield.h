#pragma once

#include "city/model/CityModel.h"
#include "city/terrain/Heightfield.h"
#include "city/terrain/Overhang.h"

namespace city {

/// The city seen from above (Meyer & Loscos 2003, section 4.2): ground, buildings and those placements whose
/// prototype counts as a column (trees: their crowns become solid, gaps of a cell between leaves filled). A
/// cell is as high as what lies over its centre; parts of buildings too thin to cover a centre (parapets,
/// free-standing walls) are kept, at most a cell too wide. Chunks of furniture (awnings, balconies, cornices,
/// signs) are left out: as columns they would stand down to the pavement and move the fronts behind them by a
/// metre. So is what hangs over lanes: storeys above a passage, and crowns as far as a parking strip beside
/// it (a car under a crown would be inside its column). Covers buildings, placements and lanes with a margin
/// of 30 m, within the city's bounds; a plain that runs on to the horizon does not blow it up. A city with
/// nothing in it gives one empty cell. Throws std::invalid_argument for a cell that is not finite and
/// positive or so small that the field would pass 2^28 cells. Cost: linear in triangles and cells.
Heightfield cityHeightfield(const CityModel& city, float cellSize = 1);

/// The same city for rays that start in the street, where a crown is no column but hangs: who stands or
/// parks under a tree is under its crown, not inside it, and sees out below it.
struct CityColumns {
    Heightfield solid;  ///< as cityHeightfield's without what hangs
    /// Crowns whose leaves begin at least 1.5 m above the ground (lower ones, bushes, are solid columns). A
    /// cell's underside is the median of those around it, so that a trunk does not reach down from it; over
    /// lanes no lower than 3 m, as trees by the road are cut. Tops are cityHeightfield's.
    Overhang hanging;
};

/// As cityHeightfield, in cells, extent, exceptions and cost.
CityColumns cityColumns(const CityModel& city, float cellSize = 1);

/// Buildings alone, each cell no higher than what stands over the whole of it: what hides behind it is hidden
/// for sure.
Heightfield occluderHeightfield(const CityModel& city, float cellSize = 2);

}  // namespace city
