#pragma once

#include <optional>
#include <span>

#include "reflection/chrome/ReflectionSearch.h"

namespace reflection {

struct VirtualOptions {
    /// Budget of searches, as a share of the vertices of all meshes that are updated together (of those drawn
    /// on their edges, too, where it is VirtualMeshes): cells are refined, those first that lie farthest off
    /// on screen, until none is off by more than the tolerance or this is spent; what is left is interpolated
    /// in its cell. Searches are no more than this and eight (the corners of its coarsest cell) for each
    /// mesh; an eighth is kept for cells that were refined in the last update. Meshes of up to sixteen
    /// vertices are searched for whole. 1: every vertex, without cells.
    double share = 0.096;
    /// False: the tolerance is met whatever it takes, and a share below 1 only says that there are cells.
    bool bounded = true;
    /// Angle, seen from the eye, by which a vertex that is not searched for may lie off: a quarter of a pixel
    /// of a 720-row view of 60 degrees.
    double cellTolerance = 0.25 * 1.155 / 720;
    /// The published grid for comparison: cells of one size, values between their corners linear, nothing
    /// looked at besides.
    bool plainGrid = false;
    /// Start from what the last update has found.
    bool remember = true;
    /// Searches of large batches run on all cores.
    bool threads = false;
    SearchOptions search = {};
    /// Set: vertices are searched for as published instead, for comparison; see
    /// findReflectionPointsAsPublished.
    std::optional<PublishedOptions> published = {};
};

/// The same options with a budget; 0: none, what the tolerance takes is searched for, and the rest follows in
/// cells.
inline VirtualOptions withShare(VirtualOptions options, double share) {
    options.bounded = share > 0;
    options.share = options.bounded ? share : VirtualOptions().share;
    return options;
}

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
