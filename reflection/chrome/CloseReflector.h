#pragma once

#include <cstdint>
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

/// What a part's open sides are closed with.
enum class Closing : std::uint8_t {
    envelope,  ///< of the tangent planes along the rim, and of a ball: where the part is convex, so is the
               ///< whole
    ball,      ///< drawn over a quarter of a face to the sphere of the part's mean radius
};

/// Gives every corner that the part leaves open a surface: past the rim the part's own slope and bend go on
/// for one cell (so that interpolation in the rim's cells is as accurate as elsewhere), then it is closed as
/// asked. Also turns normals that lie too flat for the centre. `sign`: 1 where normals face away from the
/// centre, -1 where they face it.
///
/// The envelope matters to searches: a convex body has one reflection point for every vertex outside that
/// it does not hide, so a search that ends beyond the rim has shown that there is none on the part. (Eye and
/// vertex lie before the tangent plane at a reflection point on the part; the body lies behind it: neither
/// can be inside, nor the body between them.) Its creases are rounded over two cells. Cost: linear in corners
/// times up to 192 planes.
ClosedReflector closeReflector(const CubeLattice& lattice, std::vector<ReflectorCorner>& corners, double sign,
                               Closing closing, int cellsPerSide);

}  // namespace reflection
