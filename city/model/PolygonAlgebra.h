#pragma once

#include <glm/vec2.hpp>
#include <optional>
#include <span>
#include <vector>

#include "city/model/BuildingMesh.h"

namespace city {

/// Set algebra on footprints, carried out by GEOS in double precision; results are rounded to float.
/// Results are "clean": outer rings counter-clockwise, holes clockwise, no neighbours equal, no ring without
/// area. Input rings may have any orientation, repeat corners and cross themselves. Footprints that hold a
/// number that is not finite or beyond 10,000 km, or have no area, count as empty. Nothing throws; where GEOS
/// gives up the result is empty.

struct CleanFootprints {
    std::vector<Footprint> parts;  ///< disjoint; more than one where a ring that crosses itself falls apart
    bool repaired = false;         ///< the input crossed itself, or a hole left its ring
};

/// Corners nearer than this are one corner, and corners this near to the line between their neighbours are
/// dropped: a millimetre is below any survey and above the rounding of float coordinates within 8 km of the
/// origin.
inline constexpr float cornerTolerance = 1e-3f;

/// Parts smaller than this are dropped as slivers, square metres.
inline constexpr double sliverArea = 1e-2;

/// Cost: O(n log n) in corners, as all below.
CleanFootprints cleanFootprint(const Footprint& footprint);

/// Corner triples, counter-clockwise, of one clean footprint (constrained Delaunay).
std::vector<glm::vec2> triangulateClean(const Footprint& clean);

double area(const Footprint& footprint);  ///< square metres: |outer| less |holes|, 0 with non-finite numbers
double signedArea(std::span<const glm::vec2> ring);  ///< positive counter-clockwise

std::vector<Footprint> intersection(const std::vector<Footprint>& a, const std::vector<Footprint>& b);
std::vector<Footprint> difference(const std::vector<Footprint>& a, const std::vector<Footprint>& b);
std::vector<Footprint> unite(const std::vector<Footprint>& footprints);

/// Grown (distance > 0) or shrunk (< 0) with mitred corners.
std::vector<Footprint> offset(const Footprint& footprint, double distance);

/// The strip of `width` metres along a line, its ends square.
std::vector<Footprint> strip(std::span<const glm::vec2> line, double width);

/// The polygons into which lines cut an area; lines that end within it cut nothing there.
std::vector<Footprint> splitBy(const Footprint& area, const std::vector<std::vector<glm::vec2>>& lines);

/// The rectangle of least area around an outer ring: centre, unit direction of its longer side, half sides.
struct OrientedRectangle {
    glm::vec2 centre{0};
    glm::vec2 axis{1, 0};
    glm::vec2 half{0};  ///< along `axis`, across it; half.x >= half.y

    float area() const { return 4 * half.x * half.y; }
};
/// nullopt for rings without area.
std::optional<OrientedRectangle> orientedRectangle(const Footprint& footprint);

/// Even-odd rule over all rings; points on a border may fall on either side. Cost: linear in corners.
bool contains(const Footprint& footprint, glm::vec2 point);

}  // namespace city
