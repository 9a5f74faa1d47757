#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "reflection/chrome/CubeLattice.h"

namespace reflection {

/// A corner of a reflector map while it is made.
struct ReflectorCorner {
    glm::dvec3 normal{0};   ///< unit length
    double reciprocal = 0;  ///< 1 / t of the surface at t g, g the lattice's point
    bool covered = false;   ///< by the part itself
};

struct ClosedReflector {
    std::size_t covered = 0;  ///< corners that were there; 0: nothing was done
    std::size_t tilted = 0;   ///< of them, how many had a normal that did not face away from the centre
};

/// Gives every corner that the part leaves open a surface: past the rim the part's own slope and bend go on
/// for one cell (so that interpolation in the rim's cells is as accurate as elsewhere), then the surface is
/// drawn over a quarter of a face to the sphere of the part's mean radius. Also turns normals that lie too
/// flat for the centre. `sign`: 1 where normals face away from the centre, -1 where they face it. Cost:
/// linear in corners.
ClosedReflector closeReflector(const CubeLattice& lattice, std::vector<ReflectorCorner>& corners, double sign,
                               int cellsPerSide);

}  // namespace reflection
