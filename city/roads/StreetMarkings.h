#pragma once

#include <vector>

#include "city/roads/RoadNetwork.h"
#include "city/roads/StreetLayout.h"

namespace city {

/// What is painted on or laid into the streets: strips along lines, to be drawn a little above them.
struct PaintedStrip {
    Polyline line;
    double width = 0.12;
};

std::vector<PaintedStrip> laneLines(const StreetLayout& layout);  ///< dashes, centre lines, edges of beds
std::vector<PaintedStrip> stopLinesAndCrossings(const StreetLayout& layout);
std::vector<PaintedStrip> railsOf(const RoadNetwork& roads);

}  // namespace city
