#pragma once

#include <string>
#include <utility>
#include <vector>

#include "app/commands/PreparedReflections.h"
#include "city/model/CityModel.h"

namespace app {

/// What the reflections of a city will need and why, found without drawing anything: by rays through its
/// heightfield, as reference maps would be placed, and from its lanes. Bytes of maps are estimates: what
/// packed maps take a texel depends on the picture.
struct SceneNeeds {
    std::size_t carLanes = 0, tramLanes = 0;
    std::size_t drivingPositions = 0;  ///< from which the city is looked at; none: nothing reflects
    std::size_t referenceMaps = 0;
    double coverage = 0;  ///< share of what is visible from driving positions that those see
    std::size_t referenceMapBytes = 0;
    std::size_t heightfieldCells = 0, heightfieldBytes = 0;
    std::size_t localMapBytesLeast = 0, localMapBytesMost = 0;  ///< of one vehicle, by its size on screen
};

/// Cost: that of placing reference maps, on all cores (paper: about a second).
SceneNeeds sceneNeeds(const city::CityModel& city, const PreparationOptions& options);

/// Name and text for people.
std::vector<std::pair<std::string, std::string>> describe(const SceneNeeds& needs);

}  // namespace app
