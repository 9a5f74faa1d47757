#pragma once

#include <glm/vec2.hpp>
#include <optional>
#include <vector>

#include "city/model/BuildingMesh.h"

namespace city {

/// A pitched roof as the lowest of some planes: at every point, the roof's height is the least of theirs.
/// Gabled, hipped and pyramidal roofs are all of this kind, so walls and roof meet by construction whatever
/// the footprint's corners do.
struct RoofPlane {
    glm::dvec2 slope{0};  ///< dz/dx, dz/dy
    glm::dvec2 foot{0};   ///< a point where the plane has height `level`
    double level = 0;

    double height(glm::dvec2 p) const { return level + slope.x * (p.x - foot.x) + slope.y * (p.y - foot.y); }
};

/// Planes of a roof, or none where the shape is flat, has no height, or the footprint is not like a
/// quadrilateral.
std::vector<RoofPlane> roofPlanes(const Footprint& clean, RoofShape roof, double eaves, double ridge);

/// Whether a roof of this shape can stand on the footprint; flat ones always can.
bool carriesRoof(const Footprint& clean, RoofShape roof);

/// The point that a dome rises over, if every corner can be seen from it: the outer ring's centre of gravity.
std::optional<glm::dvec2> domeCentre(const Footprint& clean);

/// Height of the lowest plane. At least one plane.
double roofHeight(const std::vector<RoofPlane>& planes, glm::dvec2 p);

/// Parameters in (0, 1), ascending, at which another plane becomes the lowest on the way from a to b.
std::vector<double> roofBreaks(const std::vector<RoofPlane>& planes, glm::dvec2 a, glm::dvec2 b);

/// Where plane `index` is the lowest: a convex ring, within `reach` metres of `centre`; empty if nowhere.
std::vector<glm::vec2> roofRegion(const std::vector<RoofPlane>& planes, std::size_t index, glm::dvec2 centre,
                                  double reach);

}  // namespace city
