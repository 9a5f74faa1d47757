#pragma once

#include "city/geometry/Mesh.h"
#include "reflection/chrome/ReflectorMap.h"

namespace reflection {

enum class ReflectorMapStatus : std::uint8_t {
    built,
    nothingSeen,    ///< no triangle with an area faces the centre the right way
    notStarShaped,  ///< some direction from the centre meets the piece more than once
};

/// How a map differs from the surface that it was made of, and what had to be left out.
struct ReflectorMapReport {
    double worstDistance =
        0;  ///< metres along the direction from the centre, over corners and middles of triangles
    double meanDistance = 0;
    double worstAngle = 0;  ///< radians between the map's normal and the interpolated one of the surface
    double meanAngle = 0;
    double coveredShare =
        0;  ///< of the cube's corners that the part itself covers; the rest is closing surface
    std::size_t skipped =
        0;  ///< triangles without area, with values that are not finite, or facing the wrong way
    std::size_t overlapping =
        0;                   ///< corners that see more than one layer; the farthest from the centre is kept
    std::size_t tilted = 0;  ///< corners whose normal had to be turned to face away from (or to) the centre
};

struct BuiltReflectorMap {
    ReflectorMapStatus status = ReflectorMapStatus::nothingSeen;
    ReflectorMap map;  ///< filled unless nothing was seen
    ReflectorMapReport report;
};

/// Makes the map of a piece that is star-shaped around the centre: seen from it the triangles' fronts face
/// away (convex) or towards it (concave). Positions are those of the flat triangles, normals those
/// interpolated between their corners, as a renderer shades them. What the piece leaves open is closed:
/// continued smoothly past its rim and then, where it is convex, by the envelope of its rim's tangent planes,
/// so that the whole is convex as well (CloseReflector.h); else drawn to the sphere of the piece's mean
/// radius. So a search that wanders off the part still has a surface to walk on; such points are not
/// `covered`.
///
/// Frame: the mesh's own, metres. Deterministic. Cost: per triangle the corners of its bounding rectangle on
/// the cube's faces, then some sweeps over 6 cells^2 corners: 5 to 50 ms for 64 cells. Source: Estalella et
/// al. 2005, sections 4.1 and 6.2 (there the closing surface is modelled by hand).
///
/// `frame` gives the centre, the axes and how the stretches are to each other; they and the scale are brought
/// to the greatest 1. `behind`: the centre lies behind the triangles (`bend` alone does not tell: saddles may
/// be seen from behind and yet have any number of reflection points).
BuiltReflectorMap buildReflectorMap(const city::Mesh& piece, const MapFrame& frame, bool behind, Bend bend,
                                    int cellsPerSide = 64);

/// The same around a centre, along the mesh's own axes and without a stretch.
BuiltReflectorMap buildReflectorMap(const city::Mesh& piece, const glm::dvec3& centre, Bend bend,
                                    int cellsPerSide = 64);

}  // namespace reflection
