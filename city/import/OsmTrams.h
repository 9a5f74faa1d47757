#pragma once

#include <vector>

#include "city/import/OsmStreets.h"

namespace city {

/// Puts tram tracks into a street graph: a street along most of which a track runs within the carriageway
/// becomes a street with a tram; what remains of the tracks becomes tram lines of their own (edges without
/// cars), one for each track.
void addTrams(const std::vector<OsmPiece>& tracks, StreetGraph& graph);

}  // namespace city
