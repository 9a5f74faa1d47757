#pragma once

#include <vector>

#include "city/generate/Palette.h"
#include "city/import/OsmData.h"
#include "city/model/BuildingMesh.h"

namespace city {

/// Ground cover, from what lies on top to what lies below: a place belongs to the first cover that claims it.
enum class Cover : std::uint8_t {
    rails,
    asphalt,
    path,
    water,
    sport,
    square,
    grass,
    meadow,
    wood,
    soil,
    count
};

struct GroundPlan {
    std::vector<std::vector<Footprint>> covers;  ///< by Cover; may overlap and reach out of the bounds
    std::vector<std::vector<glm::vec2>> tracks;  ///< axes of railway tracks
    std::size_t waterAreas = 0;
    std::size_t greenAreas = 0;
    std::size_t paths = 0;
    bool sea = false;                ///< coastlines were closed
    std::size_t openCoastlines = 0;  ///< coastlines that do not part land from sea within the bounds
};

/// Water (also the sea, on the right of coastlines, closed along the bounds), parks, squares, car parks,
/// service roads, paths and railway tracks.
GroundPlan planGround(const OsmData& data);

/// Height of the ground, metres: below the streets' carriageways, which lie at 0.
inline constexpr float groundHeight = -0.05f;

/// The ground within the bounds, parted without overlap, so that nothing can flicker: one mesh for each
/// square of `cell` metres, and an apron around all. Water lies lower. Cost: about 0.3 s for a city centre on
/// one core; cells run in parallel.
std::vector<Mesh> buildGround(const GroundPlan& plan, glm::vec2 halfSize, const Palette& palette,
                              float cell = 120);

}  // namespace city
