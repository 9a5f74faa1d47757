#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "reflection/local_map/ReferenceLookup.h"
#include "reflection/reference_maps/PackedReferenceMap.h"
#include "reflection/tracing/GridTracer.h"

namespace reflection {

/// The maps to ask for a local map at `centre`, best first: nearer ones see its surroundings at closer to the
/// right scale, and a map that the centre cannot see stands in another street, so those come after all that
/// it can see. At most `count`; all maps there are when there are fewer. Cost: linear in maps plus a few
/// rays.
std::vector<Candidate> selectCandidates(std::span<const PackedReferenceMap> maps, const glm::dvec3& centre,
                                        const GridTracer& tracer, std::size_t count);

/// The paper's choice: the two nearest.
std::vector<Candidate> selectNearestTwo(std::span<const PackedReferenceMap> maps, const glm::dvec3& centre);

}  // namespace reflection
