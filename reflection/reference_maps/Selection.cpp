#include "reflection/reference_maps/Selection.h"

#include <algorithm>
#include <glm/geometric.hpp>

namespace reflection {

namespace {

/// Candidates sorted by distance, at most `count`.
std::vector<Candidate> nearest(std::span<const PackedReferenceMap> maps, const glm::dvec3& centre,
                               std::size_t count) {
    std::vector<Candidate> all;
    all.reserve(maps.size());
    for (const PackedReferenceMap& map : maps) all.push_back({&map, glm::vec3(map.position() - centre)});
    const auto closer = [](const Candidate& a, const Candidate& b) {
        const float da = glm::dot(a.offset, a.offset), db = glm::dot(b.offset, b.offset);
        return da != db ? da < db : a.map < b.map;
    };
    count = std::min(count, all.size());
    std::partial_sort(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count), all.end(), closer);
    all.resize(count);
    return all;
}

}  // namespace

std::vector<Candidate> selectCandidates(std::span<const PackedReferenceMap> maps, const glm::dvec3& centre,
                                        const GridTracer& tracer, std::size_t count) {
    // Three times as many as wanted are looked at: around a corner about every second near map stands in
    // another street.
    std::vector<Candidate> near = nearest(maps, centre, 3 * count);
    std::stable_partition(near.begin(), near.end(), [&](const Candidate& c) {
        const TraceResult hit = tracer.trace({glm::vec3(centre), c.offset});
        return hit.status != TraceStatus::hit || hit.t >= 1;
    });
    near.resize(std::min(count, near.size()));
    return near;
}

std::vector<Candidate> selectNearestTwo(std::span<const PackedReferenceMap> maps, const glm::dvec3& centre) {
    return nearest(maps, centre, 2);
}

}  // namespace reflection
