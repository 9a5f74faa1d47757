#include "reflection/chrome/BounceEye.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "reflection/chrome/ReflectionSearch.h"

namespace reflection {

namespace {

/// Corners among which points are chosen.
constexpr std::size_t mostCorners = 4096;

/// Rays that are parallel to so many radians leave open how far away the eye is.
constexpr double parallel = 1e-5;

}  // namespace

std::vector<SurfacePoint> spreadPoints(const city::Mesh& mesh, std::size_t most) {
    std::vector<SurfacePoint> all;
    const std::size_t step = mesh.vertices.size() / mostCorners + 1;
    glm::dvec3 middle(0);
    for (std::size_t k = 0; k < mesh.vertices.size(); k += step) {
        const glm::dvec3 p(mesh.vertices[k].position), n(mesh.vertices[k].normal);
        if (!(glm::length(n) > 0.5 && glm::length(n) < 2 && std::isfinite(p.x + p.y + p.z))) continue;
        all.push_back({p, glm::normalize(n)});
        middle += p;
    }
    std::vector<SurfacePoint> chosen;
    if (all.empty()) return chosen;
    middle /= static_cast<double>(all.size());
    std::vector<double> away(all.size(), INFINITY);
    // The first is the farthest out; each next one the farthest from those before.
    glm::dvec3 last = middle;
    for (std::size_t n = 0; n < std::min(most, all.size()); ++n) {
        std::size_t farthest = 0;
        for (std::size_t i = 0; i < all.size(); ++i) {
            const double d = glm::distance(all[i].position, last);
            away[i] = n < 2 ? d : std::min(away[i], d);
            if (away[i] > away[farthest]) farthest = i;
        }
        if (n > 0 && !(away[farthest] > 0)) break;
        chosen.push_back(all[farthest]);
        last = chosen.back().position;
    }
    return chosen;
}

BounceEye bounceEye(const ReflectorMap& map, const glm::dvec3& eye, std::span<const SurfacePoint> surface,
                    const SearchOptions& search) {
    BounceEye result;
    std::vector<glm::dvec3> points;
    for (const SurfacePoint& s : surface) points.push_back(s.position);
    std::vector<ReflectionPoint> answers(points.size());
    findReflectionPoints(map, eye, points, answers, search);
    std::vector<glm::dvec3> rays;
    glm::dvec3 middle(0);
    for (std::size_t k = 0; k < points.size(); ++k) {
        if (answers[k].status != ReflectionStatus::found) continue;
        const glm::dvec3 ray = answers[k].point - points[k];
        const double length = glm::length(ray);
        if (!(length > 0) || !(glm::dot(surface[k].normal, ray) > 0)) continue;
        result.seen.push_back(k);
        result.at.push_back(answers[k].point);
        rays.push_back(ray / length);
        middle += answers[k].point;
    }
    if (rays.size() < 3) return result;
    middle /= static_cast<double>(rays.size());
    // What is least is the sum of squared angles, seen from the points; their distances to the eye are not
    // known yet, and those to the piece stand for them at first.
    glm::dvec3 found = middle;
    for (int round = 0; round < 3; ++round) {
        glm::dmat3 normal(0);
        glm::dvec3 right(0);
        double weights = 0;
        for (std::size_t k = 0; k < rays.size(); ++k) {
            const glm::dvec3& p = points[result.seen[k]];
            const double away = std::max(glm::distance(found, p), glm::distance(result.at[k], p));
            const double weight = 1 / (away * away);
            const glm::dmat3 across = glm::dmat3(1) - glm::outerProduct(rays[k], rays[k]);
            normal += weight * across;
            right += weight * (across * (p - middle));
            weights += weight;
        }
        // Nothing but the rays' spread holds it along them.
        normal += weights * parallel * parallel * glm::dmat3(1);
        found = middle + glm::inverse(normal) * right;
    }
    result.eye = found;
    double worst = 0;
    for (std::size_t k = 0; k < rays.size(); ++k) {
        const glm::dvec3 straight = found - points[result.seen[k]];
        const double length = glm::length(straight);
        if (!(length > 0)) return result;
        worst = std::max(worst,
                         std::atan2(glm::length(glm::cross(straight, rays[k])), glm::dot(straight, rays[k])));
    }
    if (std::isfinite(worst)) result.stray = worst;
    return result;
}

}  // namespace reflection
