#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "city/geometry/Mesh.h"
#include "reflection/chrome/BuildReflectorMap.h"

namespace reflection {

/// A part of a reflector that one map can hold.
struct ReflectorPiece {
    city::Mesh mesh;
    Bend bend = Bend::convex;
    double margin = 0;  ///< least cosine between a triangle's normal and the line from the map's centre to
                        ///< its corners once the stretch is taken out
    BuiltReflectorMap built;
};

/// A reflector, ready for searches. Frame: the part's, metres.
struct Reflector {
    std::vector<ReflectorPiece> pieces;  ///< largest area first
    std::size_t skipped = 0;  ///< triangles (all but) without area or with values that are not finite
};

struct CutOptions {
    int cellsPerSide = 64;
    /// Least cosine as in ReflectorPiece::margin at which a triangle may join a piece: below it the map's
    /// cells are stretched by more than ten.
    double leastMargin = 0.1;
};

/// Cuts a part into pieces that are star-shaped around a centre and convex or concave, and makes their maps.
/// Grown triangle by triangle across edges that bend the same way (flat ones join both), as long as some
/// point still sees all of them; that point is looked for where the current one fails. Each connected
/// component is measured along its principal axes, and each piece's map is stretched to its own (MapFrame),
/// so that long and flat parts need no more pieces than round ones. Where neither kind grows (saddles, as on
/// the inside of a ring) edges of both kinds are crossed and the piece is treated as concave: it may have any
/// number of reflection points. A piece that overlaps itself around its centre, or that only a far centre
/// sees, is cut anew in halves until it does not. Corners are joined by position; edges of three or more
/// triangles, or of two that face opposite ways, are borders, so that parts that are not manifold are cut
/// there instead of failing.
///
/// Every triangle with an area is in exactly one piece. Deterministic. Cost: near linear in triangles, plus
/// the maps. Source: Estalella et al. 2005, section 6.2, where this is done by hand and rings are excluded.
Reflector makeReflector(const city::Mesh& part, const CutOptions& options = {});

}  // namespace reflection
