#include "reflection/planar/MirrorPlane.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace reflection {

namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

bool finite(const glm::dvec3& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

MirrorStatus statusOf(const MirrorSurface& surface) {
    const glm::vec3& f = surface.reflectance;
    if (!finite(glm::dvec3(f)) || !std::isfinite(surface.roughness)) return MirrorStatus::notFinite;
    for (int i = 0; i < 3; ++i)
        if (f[i] < 0 || f[i] > 1) return MirrorStatus::badReflectance;
    if (surface.roughness < 0 || surface.roughness > 1) return MirrorStatus::badRoughness;
    return MirrorStatus::ok;
}

}  // namespace

std::string_view remedyOf(MirrorStatus status) {
    switch (status) {
        case MirrorStatus::ok:
            return "ok";
        case MirrorStatus::tooFewCorners:
            return "a mirror needs at least three different corners; add the missing ones";
        case MirrorStatus::notFinite:
            return "a value is not a finite number; give metres and shares as plain numbers";
        case MirrorStatus::degenerate:
            return "the corners lie on a line; move one off it";
        case MirrorStatus::notPlanar:
            return "the corners do not lie in one plane; split the mirror into triangles";
        case MirrorStatus::notConvex:
            return "the corners do not go once round a convex polygon; reorder or split it";
        case MirrorStatus::badReflectance:
            return "the reflectance lies outside 0 .. 1; give a share of the light";
        case MirrorStatus::badRoughness:
            return "the roughness lies outside 0 .. 1; 0 is a mirror, 1 is matt";
    }
    return "unknown";
}

MirrorResult MirrorPlane::make(std::span<const glm::dvec3> corners, const MirrorSurface& surface) {
    MirrorResult result;
    result.status = statusOf(surface);
    if (result.status != MirrorStatus::ok) return result;
    MirrorPlane& m = result.mirror;
    std::vector<std::size_t> given;  // index of each kept corner
    for (std::size_t i = 0; i < corners.size(); ++i) {
        if (!finite(corners[i])) {
            result.status = MirrorStatus::notFinite;
            result.corner = i;
            return result;
        }
        if (!m.corners_.empty() && corners[i] == m.corners_.back()) continue;
        m.corners_.push_back(corners[i]);
        given.push_back(i);
    }
    while (m.corners_.size() > 1 && m.corners_.front() == m.corners_.back()) m.corners_.pop_back();
    const std::size_t n = m.corners_.size();
    if (n < 3) {
        result.status = MirrorStatus::tooFewCorners;
        return result;
    }
    // Scaled by the size, so that squares neither overflow nor vanish.
    const glm::dvec3 first = m.corners_.front();
    double scale = 0;
    for (const glm::dvec3& c : m.corners_)
        for (int i = 0; i < 3; ++i) scale = std::max(scale, std::abs(c[i] - first[i]));
    if (!std::isfinite(scale) || scale <= 0) {
        result.status = MirrorStatus::degenerate;
        return result;
    }
    // Newell's normal: twice the area vector, from differences to the first corner.
    const auto at = [&](std::size_t i) { return (m.corners_[i % n] - first) / scale; };
    glm::dvec3 twice(0), mean(0);
    for (std::size_t i = 0; i < n; ++i) {
        twice += glm::cross(at(i), at(i + 1));
        mean += at(i);
    }
    mean /= static_cast<double>(n);
    const double length = glm::length(twice);
    // Below this the area is the rounding of n cross products of values up to 1; a sliver of a
    // millionth part of its length still passes.
    if (!(length > 64 * epsilon * static_cast<double>(n))) {
        result.status = MirrorStatus::degenerate;
        return result;
    }
    m.normal_ = twice / length;
    m.point_ = first + scale * mean;
    m.area_ = 0.5 * length * scale * scale;
    m.surface_ = surface;
    constexpr double flatness = 1e-4;
    double turned = 0;
    for (std::size_t i = 0; i < n; ++i) {
        m.radius_ = std::max(m.radius_, scale * glm::length(at(i) - mean));
        if (std::abs(glm::dot(m.normal_, at(i) - mean)) > flatness) {
            result.status = MirrorStatus::notPlanar;
            result.corner = given[i];
            return result;
        }
        const glm::dvec3 in = glm::normalize(at(i + 1) - at(i)), out = glm::normalize(at(i + 2) - at(i + 1));
        const double sine = glm::dot(m.normal_, glm::cross(in, out));
        const double angle = std::atan2(sine, glm::dot(in, out));
        // A corner in the middle of an edge may lean inwards by as much as it may lie off the plane.
        if (sine < -flatness || std::abs(angle) > 3.14159) {
            result.status = MirrorStatus::notConvex;
            result.corner = given[(i + 1) % n];
            return result;
        }
        turned += angle;
    }
    if (turned > 2 * 3.14159265358979 + 0.1) result.status = MirrorStatus::notConvex;
    return result;
}

double MirrorPlane::sideTolerance(const glm::dvec3& p) const {
    // The difference is rounded once, its product with a normal good to some four roundings, and summed.
    const glm::dvec3 d = glm::abs(p - point_);
    return 8 * epsilon * (d.x + d.y + d.z);
}

glm::dmat3 MirrorPlane::reflection() const {
    return glm::dmat3(1) - 2.0 * glm::outerProduct(normal_, normal_);
}

bool coplanar(const MirrorPlane& a, const MirrorPlane& b, double tolerance) {
    if (glm::dot(a.normal(), b.normal()) <= 0) return false;
    const auto near = [&](const MirrorPlane& plane, const MirrorPlane& other) {
        return std::all_of(other.corners().begin(), other.corners().end(), [&](const glm::dvec3& c) {
            return std::abs(plane.signedDistance(c)) <= tolerance;
        });
    };
    return near(a, b) && near(b, a);
}

}  // namespace reflection
