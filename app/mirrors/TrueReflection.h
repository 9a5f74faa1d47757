#pragma once

#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <vector>

#include "app/mirrors/MirrorWorld.h"

namespace app {

/// A reflection point on a curved mirror's exact surface. World frame, metres.
struct TruePoint {
    glm::dvec3 position{0};
    glm::dvec3 normal{0, 0, 1};  ///< unit length
    double residual = 0;         ///< radians between the bisector and the normal
    double path = 0;             ///< metres from the eye over the point to the vertex
};

/// The slow oracle of searches for reflection points: knows nothing of maps. Looks at every corner of the
/// mirror's drawn mesh, walks from each that is better than all its neighbours over the exact surface (a
/// ball, or the turned curve itself) by Newton's method with measured slopes, and keeps what lies within the
/// surface's arc and ends and faces both eye and vertex. What stands between is not asked.
class TrueReflection {
  public:
    explicit TrueReflection(const MirrorWorld::Curved& mirror);  ///< keeps a reference

    /// Shortest path first; empty: none. Residuals are below 1e-9. Where two points lie between the same
    /// corners of the mesh, one walk ends in one of them: `besides` are places to walk from, too, such as
    /// what a search found, whose ends stand on the exact surface like all. Cost: 30 ns a corner, then some
    /// 100 microseconds a walk. Safe on several threads.
    std::vector<TruePoint> all(const glm::dvec3& eye, const glm::dvec3& vertex,
                               std::span<const glm::dvec3> besides = {}) const;

  private:
    struct Place {
        glm::dvec3 position, normal;
        bool within;
    };
    struct Corner {
        glm::dvec3 position, normal;
        std::vector<std::uint32_t> neighbours;
    };
    Place nearest(const glm::dvec3& p) const;
    bool walk(const glm::dvec3& eye, const glm::dvec3& vertex, const glm::dvec3& from, TruePoint& end) const;

    const MirrorWorld::Curved& mirror_;
    std::vector<Corner> corners_;
};

}  // namespace app
