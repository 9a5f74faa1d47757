#pragma once

#include <vector>

#include "city/model/BuildingMesh.h"
#include "city/roads/StreetGraph.h"

namespace city {

/// Maps seldom tell widths, and usual ones can reach into houses. Narrows lanes (not below 2.75 m), then
/// drops lanes beside others of their direction, until the carriageway keeps `gap` metres from the walls
/// along most of each street. Streets that run through a building stay as they are. Returns how many streets
/// were narrowed. Cost: linear in street length, thanks to a grid of walls.
std::size_t fitStreetsBetween(const std::vector<Footprint>& buildings, StreetGraph& graph, float gap = 0.8f);

}  // namespace city
