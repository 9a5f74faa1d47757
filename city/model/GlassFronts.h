#pragma once

#include <array>
#include <cstddef>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <string>
#include <vector>

#include "city/geometry/Aabb.h"
#include "city/geometry/Mesh.h"
#include "city/model/CityModel.h"

namespace city {

/// What a polished or glazed surface does to light that falls on it straight.
struct GlassSurface {
    float reflectance = 0.08f;    ///< of the whole pane, both of its faces, at normal incidence
    float transmittance = 0.85f;  ///< of what lies behind, at normal incidence
    float roughness = 0;          ///< of MirrorPlane: 0 mirrors sharply
    /// What is painted on the wall lies at the surface, in the light of the street, and is not a room behind
    /// it: polished stone's grain, the milk of frosted glass.
    bool solid = false;

    bool operator==(const GlassSurface&) const = default;
};
/// Clear plate glass (refractive index 1.52: two faces of 4.3% each) for shops, coated sun glass for curtain
/// walls. Measured panes: 0.08 and 0.15 to 0.35.
inline constexpr GlassSurface clearGlass{}, sunGlass{0.25f, 0.6f};
/// Satin: one face is etched, with slopes of 4 degrees, that spread what it mirrors by 7.
inline constexpr GlassSurface frostedGlass{0.06f, 0.92f, 0.3f, true};
/// Feldspar and quartz, refractive index 1.54; the polish leaves 1 degree.
inline constexpr GlassSurface polishedGranite{0.045f, 0.95f, 0.15f, true};

/// A pane within one repeat of a facade's pattern, in texture coordinates.
struct PaneOfPattern {
    glm::vec2 low{0}, high{0};
    GlassSurface surface;
};

/// Where the pictures of facades (PatternImages) have panes that are large enough to mirror a street: the
/// windows and doors of shop fronts, all the glass of curtain walls; of stone fronts the polished base and
/// the frosted glass as well. Empty for all other patterns: the windows of plastered, brick and stone fronts
/// are small, divided and curtained, and stay painted.
std::span<const PaneOfPattern> panesOf(Pattern pattern);

/// The panes of one stretch of wall that are alike, all in one vertical plane: a planar reflector.
struct GlassFront {
    glm::dvec3 normal{1, 0, 0};  ///< unit, horizontal, into the street
    /// Rectangle around all panes, world metres, counter-clockwise seen from the street; it lies in the
    /// panes' plane.
    std::array<glm::dvec3, 4> outline{};
    /// The panes as planar polygons, with the wall's texture coordinates and material: what is painted on the
    /// wall is what is seen through them.
    Mesh panes;
    std::size_t paneCount = 0;
    double area = 0;  ///< of the panes, square metres
    Pattern pattern = Pattern::shopFront;
    GlassSurface glass;
    Aabb bounds;
};

/// What was looked at and left out, in words and numbers for those who ask why.
struct GlassCensus {
    std::size_t shopFronts = 0, curtainWalls = 0;  ///< listed fronts of either kind, smooth
    std::size_t frosted = 0, stones = 0;           ///< the same of frosted glass and of polished stone
    std::size_t panes = 0;
    double area = 0;             ///< of all panes, square metres
    std::size_t planes = 0;      ///< sets of coplanar fronts: mirror views that would show them all
    std::size_t tooSmall = 0;    ///< fronts with less glass than `leastGlass`
    std::size_t notUpright = 0;  ///< pieces of such material that are no upright walls
    std::size_t painted = 0;     ///< stretches of wall whose windows stay painted
};

struct GlassFronts {
    std::vector<GlassFront> fronts;
    GlassCensus census;
};

/// Panes stand so far in front of the wall that they are painted on, metres: farther than the rounding of
/// single precision moves either 10 km from the origin, and not seen from the street.
inline constexpr float paneOffset = 0.01f;
/// Square metres of glass below which a front is left out.
inline constexpr double leastGlass = 1.0;

/// Finds the glass and the polished stone of a city by its walls' materials and texture coordinates,
/// generated and imported cities alike. Panes that a wall's end cuts are kept as what is left of them. Order:
/// chunks, then triangles. Degenerate walls (no area, no extent of the texture, not finite) give nothing.
/// Cost: linear in triangles and panes; `planes` takes fronts times planes.
GlassFronts glassFronts(const CityModel& city);

}  // namespace city
