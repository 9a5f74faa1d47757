#pragma once

#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <string_view>
#include <vector>

namespace reflection {

/// What a mirror does to light.
struct MirrorSurface {
    glm::vec3 reflectance{1};  ///< specular, at normal incidence, a channel each, 0 .. 1
    float roughness = 0;       ///< 0 .. 1; the microfacets' slope width is its square (GGX)
};

enum class MirrorStatus : std::uint8_t {
    ok,
    tooFewCorners,   ///< fewer than three
    notFinite,       ///< a corner, the reflectance or the roughness
    degenerate,      ///< no area: all corners on a line, within rounding
    notPlanar,       ///< a corner lies off the plane by more than 1e-4 of the polygon's diameter
    notConvex,       ///< turns the other way at a corner, or winds round twice
    badReflectance,  ///< outside 0 .. 1
    badRoughness     ///< outside 0 .. 1
};

/// What is wrong and what to do about it, one clause without a full stop; "ok" for ok.
std::string_view remedyOf(MirrorStatus status);

struct MirrorResult;

/// A flat convex polygon that mirrors on its front, from which its corners run counter-clockwise. World
/// frame, metres, double precision: distances are kept relative to a corner, so that a mirror a million
/// metres from the origin is as good as one at it. Immutable; made by `make` alone, so it always has an area.
class MirrorPlane {
  public:
    /// Never throws. Corners that repeat their neighbour are dropped first.
    static MirrorResult make(std::span<const glm::dvec3> corners, const MirrorSurface& surface = {});

    const std::vector<glm::dvec3>& corners() const { return corners_; }
    const glm::dvec3& normal() const { return normal_; }  ///< unit, to the front
    const glm::dvec3& point() const { return point_; }    ///< in the plane: the corners' mean
    double area() const { return area_; }
    double radius() const { return radius_; }  ///< of a ball around `point` that holds the corners
    const MirrorSurface& surface() const { return surface_; }

    /// Metres, positive in front.
    double signedDistance(const glm::dvec3& p) const { return glm::dot(normal_, p - point_); }
    /// Bound on the rounding error of `signedDistance(p)`; nearer than this, the side of p is not known.
    double sideTolerance(const glm::dvec3& p) const;

    /// p's mirror image. Exact to a few roundings of |p - point|.
    glm::dvec3 mirrored(const glm::dvec3& p) const { return p - 2 * signedDistance(p) * normal_; }
    glm::dvec3 mirroredDirection(const glm::dvec3& d) const { return d - 2 * glm::dot(normal_, d) * normal_; }
    /// The linear part of the textbook's M (Real-Time Rendering 9.3.1): symmetric, its own inverse,
    /// determinant -1. Its translation is left to `mirrored`, which does not round at the origin's distance.
    glm::dmat3 reflection() const;

  private:
    MirrorPlane() = default;
    friend struct MirrorResult;
    std::vector<glm::dvec3> corners_;
    glm::dvec3 normal_{0, 0, 1};
    glm::dvec3 point_{0};
    double area_ = 0;
    double radius_ = 0;
    MirrorSurface surface_;
};

struct MirrorResult {
    MirrorStatus status = MirrorStatus::degenerate;
    MirrorPlane mirror{};    ///< of use only where the status is ok
    std::size_t corner = 0;  ///< which of the given corners is to blame, where one is
};

/// Whether two mirrors lie in one plane and face the same way, so that one mirror view serves both: the
/// corners of each within `tolerance` metres of the other's plane.
bool coplanar(const MirrorPlane& a, const MirrorPlane& b, double tolerance = 1e-3);

}  // namespace reflection
