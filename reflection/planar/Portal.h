#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "reflection/planar/EyeView.h"
#include "reflection/planar/MirrorPlane.h"

namespace reflection {

/// A half space relative to an eye, world axes: inside where dot(xyz, p - eye) + w >= 0; xyz has unit length.
using HalfSpace = glm::dvec4;

/// What an eye can see: everything inside all of them. Empty: everything.
using HalfSpaces = std::vector<HalfSpace>;

/// The sides of a rectangle of a view's image, and its near plane (`clipFromView`'s, oblique ones too). Of a
/// paraboloid: nothing, it sees all round but for a cone.
HalfSpaces frustumOf(const EyeView& view, const NdcRect& rect = {});

/// Whether a ball may be seen. May say yes to what is outside, never no to what is inside.
bool touches(const HalfSpaces& frustum, const glm::dvec3& centreRelative, double radius);
/// The same for a box.
bool touches(const HalfSpaces& frustum, const glm::dvec3& centreRelative, const glm::dvec3& halfSize);

/// A convex polygon, relative to the eye, cut to what the eye can see. Empty: nothing is left.
/// Sutherland & Hodgman; robust in that a corner's side is decided once.
std::vector<glm::dvec3> clipped(std::vector<glm::dvec3> polygon, const HalfSpaces& frustum);

enum class PortalStatus : std::uint8_t {
    ok,
    outside,  ///< nothing of the polygon is in view
    edgeOn    ///< the eye lies in its plane, within rounding: it covers no pixel
};

/// A mirror's polygon as the hole through which a reflection is seen.
struct Portal {
    PortalStatus status = PortalStatus::outside;
    std::vector<glm::dvec3> polygon;  ///< what is visible of the mirror, relative to the eye that looks at it
    NdcRect bounds;                   ///< its projection, for perspective views; else the whole image
    double area = 0;                  ///< of the projection, in units of ndc (whole image: 4)
};

/// What of the mirror an eye sees, the eye being limited by `frustum` (which should hold `frustumOf(view)`).
/// Defined for every eye, in front and behind: whoever cares for backs asks `mirrorView` first.
/// Cost: corners times half spaces.
Portal portalThrough(const EyeView& view, const HalfSpaces& frustum, const MirrorPlane& mirror);

/// What the eye behind the mirror sees through that hole: a half space for each edge of the visible polygon,
/// or for each side of its bounds where it has more than `mostEdges`, and the mirror's plane in place of the
/// near plane. `mirrored`: the view that `mirrorView` made of the one that `portal` was seen from.
HalfSpaces frustumThrough(const Portal& portal, const EyeView& mirrored, const MirrorPlane& mirror,
                          std::size_t mostEdges = 8);

/// Pixels of a grid over the whole image that the rectangle touches.
PixelRect pixelsOf(const NdcRect& rect, const glm::ivec2& grid);
/// The rectangle that these pixels cover.
NdcRect ndcOf(const PixelRect& pixels, const glm::ivec2& grid);

}  // namespace reflection
