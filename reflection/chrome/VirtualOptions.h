#pragma once

#include <optional>
#include <span>

#include "reflection/chrome/ReflectionSearch.h"

namespace reflection {

struct VirtualOptions {
    /// Share of the mesh's vertices that may be searched for; 1: all, without a grid.
    double share = 0.096;
    /// Angle, seen from the eye, by which a vertex that is not searched for may lie off: a quarter of a pixel
    /// of a 720-row view of 60 degrees.
    double cellTolerance = 0.25 * 1.155 / 720;
    /// The published grid for comparison: cells of one size, values between their corners linear, nothing
    /// looked at besides.
    bool plainGrid = false;
    /// Start from what the last update has found.
    bool remember = true;
    SearchOptions search = {};
    /// Set: vertices are searched for as published instead, for comparison; see
    /// findReflectionPointsAsPublished.
    std::optional<PublishedOptions> published = {};
};

/// One of both searches, as the options say.
void findReflectionPoints(const ReflectorMap& map, const glm::dvec3& eye,
                          std::span<const glm::dvec3> vertices, std::span<ReflectionPoint> points,
                          const VirtualOptions& options, std::span<const glm::dvec3> guesses = {});

/// How an update went.
struct VirtualCounts {
    std::size_t vertices = 0, searched = 0, nodes = 0, atOutlines = 0, inBentCells = 0;
    std::size_t found = 0, hidden = 0, unreflected = 0;  ///< of the searched ones
    std::size_t lookups = 0;

    void add(const ReflectionPoint& r) {
        ++searched;
        lookups += r.lookups;
        found += r.status == ReflectionStatus::found;
        hidden += r.status == ReflectionStatus::hidden;
        unreflected += r.status == ReflectionStatus::unreflected;
    }
};

}  // namespace reflection
