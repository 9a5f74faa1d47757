#pragma once

#include "city/import/OsmData.h"
#include "city/import/OsmHeights.h"
#include "city/import/OsmMaterials.h"

namespace city {

/// Indices into the material table.
struct Facade {
    std::uint32_t wall = 0;
    std::uint32_t groundFloor = 0;
    std::uint32_t roof = 0;
    std::uint32_t trim = 0;  ///< of ledges
};

/// What a building looks like: `building:material`, `building:colour`, `roof:material` and `roof:colour`
/// where they are tagged (on the part, else on its outline), else drawn for its kind from `hash`.
Facade chooseFacade(const OsmTags& tags, const OsmTags& outline, BuildingKind kind, bool pitched,
                    std::uint64_t hash, MaterialTable& table);

}  // namespace city
