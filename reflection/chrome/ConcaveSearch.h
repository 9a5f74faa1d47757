#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "reflection/chrome/ReflectionSearch.h"

namespace reflection {

/// Where a descent of a vertex ended. Frame and units: the map's.
struct ConcaveEnd {
    std::uint32_t vertex = 0;
    glm::dvec3 point{0}, normal{0};
    double error = 2, path = 0;
};

/// All reflection points of some vertices on a concave piece, on the part and on its closing surface: those
/// of vertex k are points[first[k]] to points[first[k + 1] - 1], shortest path first. Frame and units: the
/// map's.
struct ConcavePoints {
    std::vector<ReflectionPoint> points;
    std::vector<std::uint32_t> first;

    std::span<const ReflectionPoint> of(std::size_t vertex) const {
        return std::span(points).subspan(first[vertex], first[vertex + 1] - first[vertex]);
    }
};

/// Descents from every patch of the surface that can hold a reflection point (SurfacePatches): in floats,
/// those of all vertices side by side, then in doubles. `all`: wherever they arrive, so that what is missed
/// can only be one of two in the same few cells; eight microseconds a vertex. Else, for the shortest path on
/// the part: a descent that is arriving outside its own patch ends, for that point is its neighbour's, and
/// vertices that have no point on the part begin once more in all patches of the part, with more patience, so
/// that none is called hidden or unreflected because a descent wandered off; points on the closing surface's
/// creases may be missing. Three microseconds a vertex. Vertices must be finite.
ConcavePoints searchConcave(const ReflectorMap& map, const glm::dvec3& eye,
                            std::span<const glm::dvec3> vertices, bool all, const SearchOptions& options);

}  // namespace reflection
