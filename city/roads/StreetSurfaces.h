#pragma once

#include <cstdint>
#include <vector>

#include "city/geometry/Mesh.h"
#include "city/roads/StreetGraph.h"

namespace city {

/// Indices into the city's material table.
struct StreetMaterials {
    std::uint32_t asphalt = 0;
    std::uint32_t pavement = 0;
    std::uint32_t kerb = 0;
    std::uint32_t marking = 0;
    std::uint32_t tramBed = 0;
    std::uint32_t rail = 0;
};

/// Carriageways, junction areas, kerbs (0.12 m), pavements, lane lines, stop lines, pedestrian crossings and
/// rails, slightly above z = 0 in layers that do not z-fight. `splitLength`: meshes are cut into pieces of
/// about this size (metres) for culling.
std::vector<Mesh> buildStreetSurfaces(const StreetGraph& streets, const StreetMaterials& materials,
                                      float splitLength = 100);

}  // namespace city
