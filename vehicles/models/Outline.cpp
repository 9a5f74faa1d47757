#include "vehicles/models/Outline.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>

namespace vehicles {

Outline::Outline(const std::vector<Corner>& corners) {
    build(corners);
}

Outline::Outline(const std::vector<glm::vec2>& corners, float radius) {
    std::vector<Corner> rounded;
    rounded.reserve(corners.size());
    for (const glm::vec2& c : corners) rounded.push_back({c, radius});
    build(rounded);
}

void Outline::build(const std::vector<Corner>& corners) {
    const std::size_t n = corners.size();
    for (std::size_t i = 0; i < n; ++i) {
        const glm::vec2 c = corners[i].at;
        const glm::vec2 to0 = corners[(i + n - 1) % n].at - c, to1 = corners[(i + 1) % n].at - c;
        const float room = 0.5f * std::min(glm::length(to0), glm::length(to1));
        const float cut = std::min(corners[i].radius, room);
        if (cut < 1e-4f) {
            points_.push_back(c);
            continue;
        }
        // A parabola between the two points where the corner is cut back.
        const glm::vec2 a = c + cut * glm::normalize(to0), b = c + cut * glm::normalize(to1);
        constexpr int steps = 5;
        for (int k = 0; k <= steps; ++k) {
            const float t = static_cast<float>(k) / steps;
            points_.push_back((1 - t) * (1 - t) * a + 2 * t * (1 - t) * c + t * t * b);
        }
    }
    low_ = high_ = points_.front();
    for (const glm::vec2& p : points_) {
        low_ = glm::min(low_, p);
        high_ = glm::max(high_, p);
    }
}

float Outline::distance(const glm::vec2& p) const {
    const glm::vec2 off = glm::max(glm::max(low_ - p, p - high_), glm::vec2(0));
    if (const float away = std::max(off.x, off.y); away > 0.3f) return away;
    float nearest = std::numeric_limits<float>::max();
    bool inside = false;
    for (std::size_t i = 0, j = points_.size() - 1; i < points_.size(); j = i++) {
        const glm::vec2 e = points_[j] - points_[i], w = p - points_[i];
        const float square = glm::dot(e, e);
        const float t = square > 0 ? std::clamp(glm::dot(w, e) / square, 0.0f, 1.0f) : 0.0f;
        const glm::vec2 d = w - t * e;
        nearest = std::min(nearest, glm::dot(d, d));
        if ((points_[i].y > p.y) != (points_[j].y > p.y) &&
            p.x < e.x * (p.y - points_[i].y) / e.y + points_[i].x)
            inside = !inside;
    }
    const float d = std::sqrt(nearest);
    return inside ? -d : d;
}

namespace {
/// The larger of a guard plane's distance and the outline's, which need not be known where the guard is far
/// away.
float guarded(float guard, const Outline& outline, const glm::vec2& p) {
    return guard > 0.3f ? guard : std::max(guard, outline.distance(p));
}
}  // namespace

Field inSideView(Outline outline, float inner, float above) {
    return [o = std::move(outline), inner, above](const glm::vec3& p, const glm::vec3&) {
        return guarded(std::max(inner - std::abs(p.y), above - p.z), o, {p.x, p.z});
    };
}
Field inFrontView(Outline outline, float behind) {
    return [o = std::move(outline), behind](const glm::vec3& p, const glm::vec3&) {
        return guarded(behind - p.x, o, {std::abs(p.y), p.z});
    };
}
Field inRearView(Outline outline, float before) {
    return [o = std::move(outline), before](const glm::vec3& p, const glm::vec3&) {
        return guarded(p.x - before, o, {std::abs(p.y), p.z});
    };
}
Field roundTheFront(Outline outline, float face) {
    return [o = std::move(outline), face](const glm::vec3& p, const glm::vec3&) {
        return guarded(-p.x, o, {std::abs(p.y) + std::abs(p.x - face), p.z});
    };
}
Field roundTheRear(Outline outline, float face) {
    return [o = std::move(outline), face](const glm::vec3& p, const glm::vec3&) {
        return guarded(p.x, o, {std::abs(p.y) + std::abs(p.x - face), p.z});
    };
}
Field inTopView(Outline outline, float above) {
    return [o = std::move(outline), above](const glm::vec3& p, const glm::vec3&) {
        return guarded(above - p.z, o, {p.x, std::abs(p.y)});
    };
}
Field below(float z, float slope) {
    return [z, slope](const glm::vec3& p, const glm::vec3&) { return p.z - z - slope * p.x; };
}
Field grown(Field field, float by) {
    return [f = std::move(field), by](const glm::vec3& p, const glm::vec3& n) { return f(p, n) - by; };
}
Field both(Field a, Field b) {
    return [a = std::move(a), b = std::move(b)](const glm::vec3& p, const glm::vec3& n) {
        return std::max(a(p, n), b(p, n));
    };
}
Field either(Field a, Field b) {
    return [a = std::move(a), b = std::move(b)](const glm::vec3& p, const glm::vec3& n) {
        return std::min(a(p, n), b(p, n));
    };
}

}  // namespace vehicles
