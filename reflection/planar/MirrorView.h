#pragma once

#include <cstdint>

#include "reflection/planar/EyeView.h"
#include "reflection/planar/MirrorPlane.h"

namespace reflection {

enum class MirrorViewStatus : std::uint8_t {
    ok,
    eyeInPlane,  ///< within the rounding error of the distance: the mirror is seen edge on, it shows nothing
    eyeBehind,   ///< the eye sees the mirror's back
    notFinite    ///< the eye or its rotation
};

/// The eye behind the glass that sees the world, unmirrored, as the given eye sees it in the mirror.
struct MirrorView {
    MirrorViewStatus status = MirrorViewStatus::notFinite;
    /// What falls on a pixel here is what the mirror shows at the same pixel of the given view, whatever the
    /// projection. Its near plane is the given view's: see `obliqueNear`, or clip by the mirror's plane.
    EyeView view{};
    double distance = 0;  ///< of the eye from the plane, metres, positive in front
};

/// Defined for any eye. Where the status is not `ok`, `view` is the given one, but behind the mirror it is
/// still the mirror image, for those who draw without culling. Cost: some fifty multiplications.
/// Mirrors facing each other exactly pose no problem: each level's eye lies farther behind the glass.
MirrorView mirrorView(const EyeView& view, const MirrorPlane& mirror);

enum class ObliqueStatus : std::uint8_t {
    ok,
    /// The plane passes through the eye within its tolerance, or the eye lies in front of it: the given
    /// projection comes back unchanged.
    eyeNotBehind,
    /// Nothing of the rectangle looks through the plane; unchanged.
    nothingInFront
};

/// A projection whose near plane is the mirror: what lies between the eye behind the glass and the glass is
/// clipped without a clip distance in any shader.
struct ObliqueNear {
    ObliqueStatus status = ObliqueStatus::eyeNotBehind;
    glm::dmat4 clipFromView{1};
    /// Metres in front of the mirror, along its normal, for one unit of w - z in clip space.
    double scale = 0;
};

/// After Lengyel 2005, for reversed depth with the far plane at infinity: z = w - plane / scale, where the
/// scale is the largest growth of the plane's distance per metre of depth within `rect` (at one of its
/// corners), so that no depth falls below 0 and none is wasted. Depth is then exact at the mirror and loses
/// precision with distance: see `depthStep`; clip distances lose none. Precondition: a perspective view.
ObliqueNear obliqueNear(const EyeView& view, const MirrorPlane& mirror, const NdcRect& rect = {});

/// Metres between two points, at a place relative to the eye (world axes), that a 32 bit float depth buffer
/// can just tell apart along the line of sight. +infinity where depth does not change.
double depthStep(const glm::dmat4& clipFromRelative, const glm::dvec3& relative);

}  // namespace reflection
