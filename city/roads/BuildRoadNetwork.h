#pragma once

#include "city/roads/RoadNetwork.h"
#include "city/roads/StreetGraph.h"

namespace city {

/// Lanes, connections across junctions, conflicts, right of way and signal programmes for a street graph.
/// Streets of zero length are ignored; dead ends get a turning connection so that traffic never sticks.
/// Deterministic.
RoadNetwork buildRoadNetwork(const StreetGraph& streets);

}  // namespace city
