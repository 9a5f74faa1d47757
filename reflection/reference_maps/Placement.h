#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "reflection/tracing/GridTracer.h"

namespace reflection {

struct PlacementOptions {
    /// Share of the surface visible from the driving positions that some map must see; 0..1.
    float coverage = 0.98f;
    /// No driving position may be farther than this from its nearest map (horizontal metres on level ground):
    /// parallax, and with it the error of a stretched texel, grows with that distance. Looked at for the
    /// first driving position in each square of 8 m; the others may be up to the square's diagonal farther.
    /// 0: coverage alone decides.
    float spacing = 15;
    float mapHeight = 2.5f;  ///< metres above the driving position
    float range = 150;       ///< a map is asked for surfaces up to this far (metres)
    float sampleSize = 2;    ///< surfaces are counted in cubes of this side (metres)
    int directions = 512;    ///< rays from each driving position that find its surfaces
};

struct Placement {
    std::vector<glm::vec3> positions;  ///< in the order chosen: the first ones see most
    float coverage = 0;                ///< reached share
    std::size_t samples = 0;           ///< surface samples counted
    std::size_t candidates = 0;        ///< positions considered
};

/// Chooses where reference maps stand (the paper, section 3, leaves it to the user). What is visible is found
/// by rays from the driving positions; candidates stand over the driving positions; the greedy choice takes
/// whichever sees most of what no map sees yet (within 1 - 1/e of the best possible for its number), then
/// fills gaps wider than `spacing`. Deterministic. Empty input gives an empty placement with coverage 1.
/// Cost: candidates x samples in range, on all cores.
Placement placeReferenceMaps(const GridTracer& tracer, std::span<const glm::vec3> drivingPositions,
                             const PlacementOptions& options);

}  // namespace reflection
