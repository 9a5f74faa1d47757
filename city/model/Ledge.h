#pragma once

#include "city/model/BuildingMesh.h"

namespace city {

/// A ledge around a footprint's outer ring: a string course, or, at the eaves of a flat roof, cornice and
/// parapet in one.
struct Ledge {
    float bottom = 0;  ///< world z, metres
    float top = 0.3f;
    float overhang = 0.2f;  ///< metres beyond the wall
    float inward = 0;       ///< metres that its top reaches behind the wall's face; 0 for ledges on a wall
    std::uint32_t material = 0;
};

/// Appends the ledge: outer face, underside, top and, behind a parapet, inner face. Courtyards have none.
/// Nothing is added for footprints or heights without extent. Cost: as of a building.
void appendLedge(const Footprint& footprint, const Ledge& ledge, Mesh& mesh);

}  // namespace city
