#include "app/mirrors/TrueReflection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <map>

#include "app/mirrors/Lathe.h"

namespace app {

namespace {

/// Radians at which a walk has arrived; the slopes are measured over 1e-5 of the size, which leaves Newton's
/// method five digits a step.
constexpr double arrived = 1e-9;

/// Two ends nearer to each other than this share of the mirror's radius are one point.
constexpr double same = 1e-6;

glm::dvec3 unit(const glm::dvec3& v) {
    return v / std::max(glm::length(v), 1e-300);
}

}  // namespace

TrueReflection::TrueReflection(const MirrorWorld::Curved& mirror) : mirror_(mirror) {
    // Corners that differ in their normals (creases) are two places; those that differ in nothing are one.
    std::map<std::array<float, 6>, std::uint32_t> known;
    std::vector<std::uint32_t> ids;
    for (const LitMesh::Corner& c : mirror.mesh.corners) {
        const auto [at, added] =
            known.try_emplace({c.position.x, c.position.y, c.position.z, c.normal.x, c.normal.y, c.normal.z},
                              static_cast<std::uint32_t>(corners_.size()));
        if (added) corners_.push_back({glm::dvec3(c.position), unit(glm::dvec3(c.normal)), {}});
        ids.push_back(at->second);
    }
    for (std::size_t k = 0; k + 2 < mirror.mesh.indices.size(); k += 3)
        for (std::size_t i = 0; i < 3; ++i) {
            const std::uint32_t a = ids[mirror.mesh.indices[k + i]];
            const std::uint32_t b = ids[mirror.mesh.indices[k + (i + 1) % 3]];
            if (a == b) continue;
            corners_[a].neighbours.push_back(b);
            corners_[b].neighbours.push_back(a);
        }
}

TrueReflection::Place TrueReflection::nearest(const glm::dvec3& p) const {
    if (mirror_.surface) {
        const LatheSurface::Point at = mirror_.surface->nearest(p);
        return {at.position, at.normal, at.within};
    }
    const glm::dvec3 n = unit(p - mirror_.reflector.centre);
    return {mirror_.reflector.centre + mirror_.reflector.radius * n, n, true};
}

bool TrueReflection::walk(const glm::dvec3& eye, const glm::dvec3& vertex, const glm::dvec3& from,
                          TruePoint& end) const {
    const double size = mirror_.reflector.radius;
    struct State {
        Place at;
        glm::dvec3 across;  ///< part of the bisector along the surface
        double angle;       ///< radians
    };
    const auto look = [&](const glm::dvec3& p) {
        State s;
        s.at = nearest(p);
        const glm::dvec3 h = unit(unit(eye - s.at.position) + unit(vertex - s.at.position));
        const double along = glm::dot(h, s.at.normal);
        s.across = h - along * s.at.normal;
        s.angle = std::atan2(glm::length(s.across), along);
        return s;
    };
    State now = look(from);
    for (int k = 0; k < 60 && now.angle > arrived; ++k) {
        const glm::dvec3& n = now.at.normal;
        const glm::dvec3 u =
            unit(glm::cross(n, std::abs(n.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0)));
        const glm::dvec3 v = glm::cross(n, u);
        const double step = 1e-5 * size;
        const auto slope = [&](const glm::dvec3& along) {
            const glm::dvec3 d =
                look(now.at.position + step * along).across - look(now.at.position - step * along).across;
            return glm::dvec2(glm::dot(d, u), glm::dot(d, v)) / (2 * step);
        };
        const glm::dvec2 du = slope(u), dv = slope(v);
        const glm::dvec2 f(glm::dot(now.across, u), glm::dot(now.across, v));
        const double determinant = du.x * dv.y - dv.x * du.y;
        glm::dvec2 move((dv.x * f.y - dv.y * f.x) / determinant, (du.y * f.x - du.x * f.y) / determinant);
        const double length = glm::length(move);
        // Where the surface is no help, along the bisector.
        if (!(length < 1e100)) move = size * f;
        if (length > 0.3 * size) move *= 0.3 * size / length;
        bool better = false;
        for (int halving = 0; halving < 30 && !better; ++halving, move *= 0.5) {
            const State next = look(now.at.position + move.x * u + move.y * v);
            better = next.angle < now.angle;
            if (better) now = next;
        }
        if (!better) break;
    }
    if (!(now.angle <= arrived) || !now.at.within) return false;
    const glm::dvec3 toEye = eye - now.at.position, toVertex = vertex - now.at.position;
    if (!(glm::dot(toEye, now.at.normal) > 0 && glm::dot(toVertex, now.at.normal) >= 0)) return false;
    end = {now.at.position, now.at.normal, now.angle, glm::length(toEye) + glm::length(toVertex)};
    return true;
}

std::vector<TruePoint> TrueReflection::all(const glm::dvec3& eye, const glm::dvec3& vertex,
                                           std::span<const glm::dvec3> besides) const {
    std::vector<double> cosines;
    cosines.reserve(corners_.size());
    for (const Corner& c : corners_)
        cosines.push_back(glm::dot(unit(unit(eye - c.position) + unit(vertex - c.position)), c.normal));
    std::vector<TruePoint> found;
    const auto walkFrom = [&](const glm::dvec3& from) {
        TruePoint end;
        if (!walk(eye, vertex, from, end)) return;
        const bool known = std::any_of(found.begin(), found.end(), [&](const TruePoint& p) {
            return glm::distance(p.position, end.position) < same * mirror_.reflector.radius;
        });
        if (!known) found.push_back(end);
    };
    for (std::size_t k = 0; k < corners_.size(); ++k) {
        if (!(cosines[k] > 0)) continue;
        const bool best = std::all_of(corners_[k].neighbours.begin(), corners_[k].neighbours.end(),
                                      [&](std::uint32_t other) { return cosines[other] <= cosines[k]; });
        if (best) walkFrom(corners_[k].position);
    }
    for (const glm::dvec3& from : besides) walkFrom(from);
    std::sort(found.begin(), found.end(),
              [](const TruePoint& a, const TruePoint& b) { return a.path < b.path; });
    return found;
}

}  // namespace app
