#include "city/roads/Polyline.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

namespace city {

namespace {

double planDistance(const glm::dvec3& a, const glm::dvec3& b) {
    return std::hypot(b.x - a.x, b.y - a.y);
}

glm::dvec3 planDirection(const glm::dvec3& a, const glm::dvec3& b) {
    const double d = planDistance(a, b);
    return d > 0 ? glm::dvec3((b.x - a.x) / d, (b.y - a.y) / d, 0) : glm::dvec3(1, 0, 0);
}

void appendBezier(Polyline& out, const glm::dvec3& p0, const glm::dvec3& p1, const glm::dvec3& p2,
                  const glm::dvec3& p3, double spacing) {
    // The control polygon is at least as long as the curve, and the fastest stretch of a cubic runs at most
    // at three times its longest control leg.
    const double fastest =
        3 * std::max({glm::distance(p0, p1), glm::distance(p1, p2), glm::distance(p2, p3)});
    const int n = std::clamp(static_cast<int>(std::ceil(fastest / spacing)), 2, 400);
    for (int i = 1; i <= n; ++i) {
        const double t = static_cast<double>(i) / n;
        const double s = 1 - t;
        out.push_back(s * s * s * p0 + 3 * s * s * t * p1 + 3 * s * t * t * p2 + t * t * t * p3);
    }
}

}  // namespace

glm::dvec3 rightOf(const glm::dvec3& direction) {
    return {direction.y, -direction.x, 0};
}

double turnAngle(const glm::dvec3& u, const glm::dvec3& v) {
    return std::atan2(u.x * v.y - u.y * v.x, u.x * v.x + u.y * v.y);
}

Polyline withoutDuplicates(std::span<const glm::dvec3> points, double tolerance) {
    Polyline out;
    for (const glm::dvec3& p : points) {
        if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) continue;
        if (out.empty() || planDistance(out.back(), p) > tolerance)
            out.push_back(p);
        else if (&p == &points.back() && out.size() > 1)
            out.back() = p;
    }
    return out;
}

double lengthOf(const Polyline& line) {
    double sum = 0;
    for (std::size_t i = 1; i < line.size(); ++i) sum += planDistance(line[i - 1], line[i]);
    return sum;
}

glm::dvec3 pointAt(const Polyline& line, double distance) {
    if (line.empty()) return glm::dvec3(0);
    if (distance <= 0) return line.front();
    for (std::size_t i = 1; i < line.size(); ++i) {
        const double d = planDistance(line[i - 1], line[i]);
        if (distance <= d && d > 0) return glm::mix(line[i - 1], line[i], distance / d);
        distance -= d;
    }
    return line.back();
}

glm::dvec3 directionAt(const Polyline& line, double distance) {
    if (line.size() < 2) return {1, 0, 0};
    for (std::size_t i = 1; i < line.size(); ++i) {
        const double d = planDistance(line[i - 1], line[i]);
        if (distance <= d && d > 0) return planDirection(line[i - 1], line[i]);
        distance -= d;
    }
    return planDirection(line[line.size() - 2], line.back());
}

Polyline partOf(const Polyline& line, double a, double b) {
    Polyline out{pointAt(line, a)};
    double s = 0;
    for (std::size_t i = 1; i < line.size(); ++i) {
        s += planDistance(line[i - 1], line[i]);
        if (s > a && s < b) out.push_back(line[i]);
    }
    out.push_back(pointAt(line, b));
    return withoutDuplicates(out, 1e-3);
}

Polyline reversed(Polyline line) {
    std::reverse(line.begin(), line.end());
    return line;
}

Polyline rounded(const Polyline& line, double radius) {
    if (line.size() < 3) return line;
    Polyline out{line.front()};
    for (std::size_t i = 1; i + 1 < line.size(); ++i) {
        const glm::dvec3 u = planDirection(line[i - 1], line[i]);
        const glm::dvec3 v = planDirection(line[i], line[i + 1]);
        const double angle = std::abs(turnAngle(u, v));
        const double legs = std::min(planDistance(line[i - 1], line[i]), planDistance(line[i], line[i + 1]));
        const double tangent = std::min(radius * std::tan(0.5 * std::min(angle, 2.8)), 0.48 * legs);
        if (angle < 0.01 || tangent < 0.05) {
            out.push_back(line[i]);
            continue;
        }
        const glm::dvec3 a = glm::mix(line[i], line[i - 1], tangent / planDistance(line[i - 1], line[i]));
        const glm::dvec3 b = glm::mix(line[i], line[i + 1], tangent / planDistance(line[i], line[i + 1]));
        const int n = std::clamp(static_cast<int>(std::ceil(std::max(2 * tangent, angle / 0.15))), 2, 60);
        for (int k = 0; k <= n; ++k) {
            const double t = static_cast<double>(k) / n;
            out.push_back((1 - t) * (1 - t) * a + 2 * t * (1 - t) * line[i] + t * t * b);
        }
    }
    out.push_back(line.back());
    return withoutDuplicates(out, 0.02);
}

Polyline offsetToTheRight(const Polyline& line, double offset) {
    if (line.size() < 2) return line;
    Polyline out;
    for (std::size_t i = 0; i < line.size(); ++i) {
        const glm::dvec3 u = planDirection(line[i == 0 ? 0 : i - 1], line[i == 0 ? 1 : i]);
        const glm::dvec3 v = i + 1 < line.size() ? planDirection(line[i], line[i + 1]) : u;
        const glm::dvec3 sum = u + v;
        const double n = glm::length(sum);
        const glm::dvec3 mean = n > 1e-6 ? sum / n : u;
        // At a corner the parallel curve runs further out by 1 / cos(half the turn); held to twice for sharp
        // ones.
        const double stretch = std::min(2.0, 1 / std::max(0.25, glm::dot(mean, u)));
        const glm::dvec3 p = line[i] + rightOf(mean) * (offset * stretch);
        const bool last = i + 1 == line.size();
        if (!out.empty() && glm::dot(p - out.back(), u) <= 1e-3) {
            // Runs backwards: inside of a bend tighter than the offset.
            if (!last) continue;
            while (out.size() > 1 && glm::dot(p - out.back(), u) <= 1e-3) out.pop_back();
        }
        out.push_back(p);
    }
    Polyline clean = withoutDuplicates(out, 1e-3);
    if (clean.size() < 2) {
        const glm::dvec3 u = planDirection(line.front(), line.back());
        clean = {line.front() + rightOf(u) * offset, line.back() + rightOf(u) * offset};
    }
    return clean;
}

Polyline smoothCurve(const glm::dvec3& p, const glm::dvec3& u, const glm::dvec3& q, const glm::dvec3& v,
                     double spacing) {
    const double chord = planDistance(p, q);
    const double angle = std::abs(turnAngle(u, v));
    // Handle of the cubic that best follows a circle's arc of this turn over this chord.
    double hp = chord * (angle < 1e-3 ? 1.0 / 3 : 2.0 / 3 * std::tan(angle / 4) / std::sin(angle / 2));
    double hq = hp;
    const double cross = u.x * v.y - u.y * v.x;
    if (std::abs(cross) > 0.2) {
        // Where the tangents meet ahead, legs of different length get handles in proportion: no bulge beyond
        // the corner.
        const glm::dvec3 d = q - p;
        const double a = (d.x * v.y - d.y * v.x) / cross;
        const double b = (d.x * u.y - d.y * u.x) / cross;
        if (a > 0.1 * chord && b < -0.1 * chord) {
            const double k = 4.0 / 3 * std::tan(angle / 4) / std::tan(angle / 2);
            hp = k * a;
            hq = -k * b;
        }
    }
    Polyline out{p};
    appendBezier(out, p, p + u * hp, q - v * hq, q, spacing);
    return withoutDuplicates(out, 1e-3);
}

Nearest nearestOn(const Polyline& line, const glm::dvec3& p) {
    Nearest best{0, std::numeric_limits<double>::infinity(), false};
    double s = 0;
    for (std::size_t i = 1; i < line.size(); ++i) {
        const glm::dvec3& a = line[i - 1];
        const double dx = line[i].x - a.x;
        const double dy = line[i].y - a.y;
        const double l2 = dx * dx + dy * dy;
        const double raw = l2 > 0 ? ((p.x - a.x) * dx + (p.y - a.y) * dy) / l2 : 0;
        const double t = std::clamp(raw, 0.0, 1.0);
        const double d = std::hypot(p.x - a.x - t * dx, p.y - a.y - t * dy);
        const double l = std::sqrt(l2);
        if (d < best.distance) best = {s + t * l, d, i == 1 && raw < 0};
        s += l;
    }
    return best;
}

}  // namespace city
