#pragma once

#include "city/roads/RoadNetwork.h"
#include "city/terrain/Heightfield.h"

namespace city {

/// Empties (-infinity) the cells whose centres lie within a lane's or a junction way's half width and
/// `beside` metres more of its centre line, ends rounded. Where vehicles are nothing reaches down to the
/// road: what a heightfield has there hangs over it (crowns, storeys above a passage), and as a column it
/// would have every ray of a car under it start inside the solid. Lines of fewer than two points, or with
/// points that are not finite, clear nothing. Cost: cells in the boxes around the lines' segments.
void clearLanes(const RoadNetwork& roads, float beside, Heightfield& field);

}  // namespace city
