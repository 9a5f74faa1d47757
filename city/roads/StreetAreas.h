#pragma once

#include "city/roads/Region.h"
#include "city/roads/StreetLayout.h"

namespace city {

/// The ground of all streets, parted without overlap.
struct StreetAreas {
    Region carriageway;
    Region tramBed;   ///< level with the carriageway
    Region pavement;  ///< raised: beside the streets, and islands between their directions
    Region kerb;      ///< raised: the stone edge of pavements towards carriageway and tram bed
};
StreetAreas areasOf(const StreetLayout& layout);

}  // namespace city
