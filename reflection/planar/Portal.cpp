#include "reflection/planar/Portal.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace reflection {

namespace {

void addUnit(HalfSpaces& frustum, const glm::dvec4& plane) {
    const double length = glm::length(glm::dvec3(plane));
    if (length > 0 && std::isfinite(length)) frustum.push_back(plane / length);
}

double distance(const HalfSpace& h, const glm::dvec3& p) {
    return glm::dot(glm::dvec3(h), p) + h.w;
}

glm::dvec4 rowOf(const glm::dmat4& m, int i) {
    return {m[0][i], m[1][i], m[2][i], m[3][i]};
}

}  // namespace

HalfSpaces frustumOf(const EyeView& view, const NdcRect& rect) {
    HalfSpaces frustum;
    if (view.projection != Projection::perspective) return frustum;
    const glm::dmat4 clip = view.clipFromRelative();
    const glm::dvec4 x = rowOf(clip, 0), y = rowOf(clip, 1), z = rowOf(clip, 2), w = rowOf(clip, 3);
    addUnit(frustum, x - rect.low.x * w);
    addUnit(frustum, rect.high.x * w - x);
    addUnit(frustum, y - rect.low.y * w);
    addUnit(frustum, rect.high.y * w - y);
    addUnit(frustum, w - z);
    return frustum;
}

bool touches(const HalfSpaces& frustum, const glm::dvec3& centreRelative, double radius) {
    return std::all_of(frustum.begin(), frustum.end(),
                       [&](const HalfSpace& h) { return distance(h, centreRelative) >= -radius; });
}

bool touches(const HalfSpaces& frustum, const glm::dvec3& centreRelative, const glm::dvec3& halfSize) {
    return std::all_of(frustum.begin(), frustum.end(), [&](const HalfSpace& h) {
        return distance(h, centreRelative) >= -glm::dot(glm::abs(glm::dvec3(h)), halfSize);
    });
}

std::vector<glm::dvec3> clipped(std::vector<glm::dvec3> polygon, const HalfSpaces& frustum) {
    std::vector<glm::dvec3> kept;
    std::vector<double> side;
    for (const HalfSpace& h : frustum) {
        const std::size_t n = polygon.size();
        side.resize(n);
        bool anyOutside = false;
        for (std::size_t i = 0; i < n; ++i) {
            side[i] = distance(h, polygon[i]);
            anyOutside = anyOutside || !(side[i] >= 0);
        }
        if (!anyOutside) continue;
        kept.clear();
        for (std::size_t i = 0; i < n; ++i) {
            const std::size_t j = (i + 1) % n;
            if (side[i] >= 0) kept.push_back(polygon[i]);
            if ((side[i] >= 0) != (side[j] >= 0))
                kept.push_back(polygon[i] + side[i] / (side[i] - side[j]) * (polygon[j] - polygon[i]));
        }
        polygon.swap(kept);
        if (polygon.size() < 3) return {};
    }
    return polygon;
}

Portal portalThrough(const EyeView& view, const HalfSpaces& frustum, const MirrorPlane& mirror) {
    Portal portal;
    if (std::abs(mirror.signedDistance(view.eye)) <= mirror.sideTolerance(view.eye)) {
        portal.status = PortalStatus::edgeOn;
        return portal;
    }
    portal.polygon.reserve(mirror.corners().size() + 4);
    for (const glm::dvec3& c : mirror.corners()) portal.polygon.push_back(c - view.eye);
    portal.polygon = clipped(std::move(portal.polygon), frustum);
    if (portal.polygon.empty()) return portal;
    if (view.projection != Projection::perspective) {
        // The solid angle would be the better measure; the ball's disc bounds it well enough for an order.
        const double d = std::max(glm::length(mirror.point() - view.eye), mirror.radius());
        portal.area = std::min(4.0, 3.14159265 * mirror.radius() * mirror.radius() / (d * d));
        portal.status = PortalStatus::ok;
        return portal;
    }
    const glm::dmat4 clip = view.clipFromRelative();
    constexpr double infinity = std::numeric_limits<double>::infinity();
    NdcRect bounds{glm::dvec2(infinity), glm::dvec2(-infinity)};
    std::vector<glm::dvec2> flat;
    for (const glm::dvec3& p : portal.polygon) {
        const glm::dvec4 c = clip * glm::dvec4(p, 1);
        // A corner left on the plane through the eye by rounding lies at the image's edge, or beyond.
        const double w = std::max(c.w, 1e-12 * (std::abs(c.x) + std::abs(c.y)) + 1e-300);
        flat.emplace_back(std::clamp(c.x / w, -4.0, 4.0), std::clamp(c.y / w, -4.0, 4.0));
        bounds.low = glm::min(bounds.low, flat.back());
        bounds.high = glm::max(bounds.high, flat.back());
    }
    double twice = 0;
    for (std::size_t i = 0; i < flat.size(); ++i) {
        const glm::dvec2 a = flat[i] - flat[0], b = flat[(i + 1) % flat.size()] - flat[0];
        twice += a.x * b.y - a.y * b.x;
    }
    portal.area = 0.5 * std::abs(twice);
    // Rounding may have put a corner outside by a hair; what is outside the image is not drawn.
    portal.bounds.low = glm::max(bounds.low, glm::dvec2(-1));
    portal.bounds.high = glm::min(bounds.high, glm::dvec2(1));
    if (portal.bounds.empty()) {
        portal.polygon.clear();
        return portal;
    }
    portal.status = PortalStatus::ok;
    return portal;
}

HalfSpaces frustumThrough(const Portal& portal, const EyeView& mirrored, const MirrorPlane& mirror,
                          std::size_t mostEdges) {
    HalfSpaces frustum;
    if (portal.status == PortalStatus::ok && mirrored.projection == Projection::perspective) {
        if (portal.polygon.size() > mostEdges) {
            frustum = frustumOf(mirrored, portal.bounds);
            frustum.pop_back();  // the near plane of the eye before the glass
        } else {
            // The polygon lies in the mirror, so it is its own image: moved to the new eye it has the same
            // corners.
            const std::size_t n = portal.polygon.size();
            std::vector<glm::dvec3> at(n);
            glm::dvec3 middle(0);
            const double d = 2 * mirror.signedDistance(mirrored.eye);
            for (std::size_t i = 0; i < n; ++i) {
                // p - eye' = (p - eye) + (eye - eye'), and eye - eye' = -2 distance(eye') normal
                at[i] = portal.polygon[i] - d * mirror.normal();
                middle += at[i] / static_cast<double>(n);
            }
            for (std::size_t i = 0; i < n; ++i) {
                const glm::dvec3 side = glm::cross(at[i], at[(i + 1) % n]);
                const double length = glm::length(side);
                // An edge of no length, or one that points at the eye, bounds nothing.
                if (!(length > 1e-14 * glm::length(at[i]) * glm::length(at[(i + 1) % n]))) continue;
                glm::dvec3 normal = side / length;
                if (glm::dot(normal, middle) < 0) normal = -normal;
                frustum.emplace_back(normal, 0.0);
            }
        }
    }
    frustum.emplace_back(mirror.normal(), mirror.signedDistance(mirrored.eye));
    return frustum;
}

PixelRect pixelsOf(const NdcRect& rect, const glm::ivec2& grid) {
    const glm::dvec2 size(grid);
    // A millionth of a pixel more, for the roundings on the way.
    constexpr double hair = 1e-6;
    const glm::dvec2 low = glm::floor((rect.low * 0.5 + 0.5) * size - hair);
    const glm::dvec2 high = glm::ceil((rect.high * 0.5 + 0.5) * size + hair);
    return {glm::ivec2(glm::clamp(low, glm::dvec2(0), size)),
            glm::ivec2(glm::clamp(high, glm::dvec2(0), size))};
}

NdcRect ndcOf(const PixelRect& pixels, const glm::ivec2& grid) {
    const glm::dvec2 size(glm::max(grid, glm::ivec2(1)));
    return {glm::dvec2(pixels.low) / size * 2.0 - 1.0, glm::dvec2(pixels.high) / size * 2.0 - 1.0};
}

}  // namespace reflection
