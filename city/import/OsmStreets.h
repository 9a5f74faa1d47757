#pragma once

#include <vector>

#include "city/import/OsmData.h"
#include "city/roads/StreetGraph.h"

namespace city {

/// A way cut where it leaves the city or where the file lacks its nodes. Cut ends have node 0.
struct OsmPiece {
    const OsmLine* way = nullptr;
    std::vector<std::int64_t> nodes;
    std::vector<glm::vec2> points;
};
/// The pieces of a way within the city's bounds, in its direction.
std::vector<OsmPiece> piecesWithin(const OsmLine& way, glm::vec2 halfSize);

enum class WayUse : std::uint8_t { none, cars, service, path, steps, tram, rail };
/// What a way carries; `none` for what is not built, not open, or no way at all.
WayUse wayUse(const OsmTags& tags);

/// A named or main street: shops stand along it.
bool isMainStreet(const OsmTags& tags);

struct StreetPlan {
    StreetGraph graph;  ///< streets for cars, with trams where rails lie in them; tram lines of their own
    std::vector<std::vector<glm::vec2>> mainStreets;
    std::size_t carWays = 0;  ///< drawn, at least in part
    std::size_t tramWays = 0;
    std::size_t tunnels = 0;          ///< ways of any use left out
    std::size_t bridges = 0;          ///< drawn at ground level
    std::size_t guessedLanes = 0;     ///< car ways without `lanes`
    std::size_t signals = 0;          ///< traffic signals on the streets
    std::size_t strandedSignals = 0;  ///< not on a street that is drawn
};

/// Car lanes, directions, speeds and widths from the tags and, where they are silent, from the class of the
/// road; split where ways share nodes and at signals. Nodes lie at z = 0. Cost: linear in nodes, plus tram
/// points times streets nearby.
StreetPlan planStreets(const OsmData& data);

}  // namespace city
