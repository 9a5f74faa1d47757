#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "reflection/gl/SceneDrawer.h"
#include "reflection/reference_maps/PackedReferenceMap.h"
#include "reflection/reference_maps/Store.h"

namespace reflection {

struct BakeOptions {
    int faceSize = 256;
    int supersampling = 2;
};

struct BakeResult {
    std::vector<PackedReferenceMap> maps;  ///< in the order of the positions; fewer when interrupted
    std::size_t loaded = 0;                ///< taken from the store
    std::size_t baked = 0;                 ///< rendered now
    std::vector<std::string>
        damaged;           ///< files that were there but could not be used, with the reason; rebuilt
    bool complete = true;  ///< false: `carryOn` said stop
};

/// The reference maps at these positions: from the store where it has them, else rendered and stored. Loading
/// uses all cores; rendering happens on this thread. `carryOn(done, total)` is asked after every map; what is
/// finished when it says stop stays in the store. `store` may be null: nothing is kept. Throws
/// std::runtime_error when the store cannot be written.
BakeResult bakeReferenceMaps(SceneDrawer& drawer, std::span<const glm::dvec3> positions,
                             const ReferenceMapStore* store, const BakeOptions& options,
                             const std::function<bool(std::size_t, std::size_t)>& carryOn);

}  // namespace reflection
