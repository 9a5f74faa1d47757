#pragma once

#include <vector>

#include "city/import/OsmData.h"
#include "city/import/OsmMaterials.h"
#include "city/model/BuildingMesh.h"
#include "city/model/Ledge.h"

namespace city {

/// A building, or a part of one, ready to be meshed. World frame.
struct BuildingPlan {
    std::int64_t id = 0;
    BuildingShape shape;
    std::vector<Ledge> ledges;  ///< around the shape's outer ring
};

struct BuildingPlans {
    std::vector<BuildingPlan> plans;
    std::size_t buildings = 0;  ///< outlines within the bounds, drawn whole or by their parts
    std::size_t parts = 0;
    std::size_t guessedHeights = 0;    ///< of buildings and parts
    std::size_t replacedOutlines = 0;  ///< their parts are drawn in their place
    std::size_t keptRemainders = 0;    ///< ... and what the parts leave free, too
    std::size_t outside = 0;
    std::size_t underground = 0;
    std::size_t floating = 0;  ///< small parts high above anything
};

/// Under the ground: `location=underground`, a negative `layer` or `level`, a `tunnel`.
bool isUnderground(const OsmTags& tags);

/// Every building and part within the bounds, with its height, roof and face. Parts replace the outline they
/// lie in. The ground floor has shop fronts where the file has a shop or a building of trade, or along
/// `mainStreets`. Cost: grows with buildings times the points of main streets; about 0.1 s for a city centre.
BuildingPlans planBuildings(const OsmData& data, const std::vector<std::vector<glm::vec2>>& mainStreets,
                            std::uint64_t seed, MaterialTable& table);

}  // namespace city
