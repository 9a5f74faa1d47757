#include "app/mirrors/Lathe.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <sstream>
#include <utility>

namespace app {

namespace {

constexpr double turn = 6.283185307179586;
/// Guides a segment: between two of them the distance to a point has one least value, unless the curve bends
/// by more than a right angle within a sixteenth of a segment.
constexpr int guidesPerSegment = 16;

bool isClosed(const std::vector<glm::dvec2>& points) {
    return points.size() > 3 && points.front() == points.back();
}

/// The profile's smooth parts, parted where a point is given twice.
std::vector<std::vector<glm::dvec2>> partsOf(const std::vector<glm::dvec2>& profile) {
    std::vector<std::vector<glm::dvec2>> parts(1);
    for (const glm::dvec2& p : profile) {
        if (!parts.back().empty() && parts.back().back() == p) parts.emplace_back();
        parts.back().push_back(p);
    }
    return parts;
}

/// A x = b, A dense; pivots by the largest of a column. Splines' matrices are regular.
std::vector<double> solved(std::vector<std::vector<double>> a, std::vector<double> b) {
    const std::size_t n = b.size();
    for (std::size_t k = 0; k < n; ++k) {
        std::size_t pivot = k;
        for (std::size_t i = k + 1; i < n; ++i)
            if (std::abs(a[i][k]) > std::abs(a[pivot][k])) pivot = i;
        std::swap(a[k], a[pivot]);
        std::swap(b[k], b[pivot]);
        for (std::size_t i = k + 1; i < n; ++i) {
            const double f = a[i][k] / a[k][k];
            if (f == 0) continue;
            for (std::size_t j = k; j < n; ++j) a[i][j] -= f * a[k][j];
            b[i] -= f * b[k];
        }
    }
    for (std::size_t k = n; k-- > 0;) {
        for (std::size_t j = k + 1; j < n; ++j) b[k] -= a[k][j] * b[j];
        b[k] /= a[k][k];
    }
    return b;
}

/// Derivatives at the knots of the cubic spline through one coordinate of the points; at an end marked flat
/// the derivative is zero, at others the second one is.
std::vector<double> splineSlopes(const std::vector<double>& knots, const std::vector<double>& x, bool closed,
                                 bool flatStart, bool flatEnd) {
    const std::size_t n = closed ? x.size() - 1 : x.size();
    std::vector<std::vector<double>> a(n, std::vector<double>(n, 0));
    std::vector<double> b(n, 0);
    const auto step = [&](std::size_t i) { return knots[i + 1] - knots[i]; };
    const auto slope = [&](std::size_t i) { return (x[i + 1] - x[i]) / step(i); };
    for (std::size_t i = 0; i < n; ++i) {
        const std::size_t before = i > 0 ? i - 1 : n - 1;
        if (closed || (i > 0 && i + 1 < n)) {
            a[i][before] += step(i);
            a[i][i] += 2 * (step(before) + step(i));
            a[i][(i + 1) % n] += step(before);
            b[i] = 3 * (step(i) * slope(before) + step(before) * slope(i));
        } else if (i == 0) {
            a[0][0] = flatStart ? 1 : 2;
            a[0][1] = flatStart ? 0 : 1;
            b[0] = flatStart ? 0 : 3 * slope(0);
        } else {
            a[i][i] = flatEnd ? 1 : 2;
            a[i][before] = flatEnd ? 0 : 1;
            b[i] = flatEnd ? 0 : 3 * slope(before);
        }
    }
    std::vector<double> slopes = solved(std::move(a), std::move(b));
    if (closed) slopes.push_back(slopes.front());
    return slopes;
}

}  // namespace

int Lathe::triangles() const {
    int segments = -1;
    for (std::size_t i = 0; i < profile.size(); ++i) segments += i == 0 || profile[i] != profile[i - 1];
    const int poles = static_cast<int>(profile.front().x == 0) + static_cast<int>(profile.back().x == 0);
    return slices * (2 * steps * segments - poles);
}

Lathe Lathe::finer(int times) const {
    Lathe fine = *this;
    fine.steps *= times;
    fine.slices *= times;
    return fine;
}

std::optional<LatheProblem> latheProblem(const Lathe& lathe) {
    const auto point = [&](std::size_t i) {
        std::ostringstream says;
        says << "point " << i << " of the profile, [" << lathe.profile[i].x << ", " << lathe.profile[i].y
             << "], ";
        return says.str();
    };
    const std::vector<glm::dvec2>& p = lathe.profile;
    if (p.size() < 2) return LatheProblem{"the profile has fewer than two points", "add some"};
    for (std::size_t i = 0; i < p.size(); ++i) {
        if (!std::isfinite(p[i].x) || !std::isfinite(p[i].y))
            return LatheProblem{point(i) + "is not finite", "correct it"};
        if (p[i].x < 0) return LatheProblem{point(i) + "has a negative radius", "make it 0 or more"};
        if (p[i].x == 0 && i > 0 && i + 1 < p.size())
            return LatheProblem{point(i) + "lies on the axis",
                                "let only the first and the last one lie there, or make two lathes"};
    }
    if (isClosed(p) && p.front().x == 0)
        return LatheProblem{"the profile closes on the axis", "begin it elsewhere, or leave it open"};
    for (const std::vector<glm::dvec2>& part : partsOf(p))
        if (part.size() < 2)
            return LatheProblem{"a point of the profile is given three times, or twice at an end",
                                "give it twice for a crease, between other points"};
    if (p.size() == 2 && p[0].x == 0 && p[1].x == 0)
        return LatheProblem{"the profile lies on the axis", "add a point beside it"};
    if (!(glm::length(lathe.axis) > 0) || !std::isfinite(glm::length(lathe.axis)))
        return LatheProblem{"the axis has no direction", "give it a length"};
    if (!(lathe.from < lathe.to && lathe.to <= lathe.from + turn * (1 + 1e-12)))
        return LatheProblem{"the arc is empty or more than a whole turn", "let it end after it begins"};
    if (lathe.steps < 1 || lathe.slices < 3)
        return LatheProblem{"there are too few steps or slices", "take one step and three slices at least"};
    // The curve between the points may pass the axis where they do not.
    Lathe coarse = lathe;
    coarse.slices = 3;
    const LatheSurface surface(coarse);
    for (const LitMesh::Corner& c : surface.mesh(glm::vec3(1), glm::vec3(1)).corners)
        if (!(glm::dot(c.normal, c.normal) > 0.5f))
            return LatheProblem{"the curve through the profile's points crosses the axis or stands still",
                                "add points where it bends, or creases"};
    return std::nullopt;
}

LatheSurface::Run LatheSurface::splined(const std::vector<glm::dvec2>& points) {
    Run run;
    run.points = points;
    run.closed = isClosed(points);
    double t = 0;
    std::vector<double> radii, heights;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (i > 0) t += glm::length(points[i] - points[i - 1]);
        run.knots.push_back(t);
        radii.push_back(points[i].x);
        heights.push_back(points[i].y);
    }
    // Mirrored at the axis, the curve goes on: its height is even, its radius odd.
    const std::vector<double> r = splineSlopes(run.knots, radii, run.closed, false, false);
    const std::vector<double> h =
        splineSlopes(run.knots, heights, run.closed, radii.front() == 0, radii.back() == 0);
    for (std::size_t i = 0; i < points.size(); ++i) run.slopes.emplace_back(r[i], h[i]);
    return run;
}

LatheSurface::CurvePoint LatheSurface::sample(const Run& run, double t) {
    const double length = run.knots.back();
    if (run.closed) t -= length * std::floor(t / length);
    t = std::clamp(t, 0.0, length);
    const auto above = std::upper_bound(run.knots.begin(), run.knots.end(), t) - run.knots.begin();
    const std::size_t i = std::min<std::size_t>(static_cast<std::size_t>(above), run.knots.size() - 1) - 1;
    const double h = run.knots[i + 1] - run.knots[i], s = (t - run.knots[i]) / h;
    const glm::dvec2 &a = run.points[i], &b = run.points[i + 1];
    const glm::dvec2 da = h * run.slopes[i], db = h * run.slopes[i + 1];
    const glm::dvec2 c2 = 3.0 * (b - a) - 2.0 * da - db, c3 = 2.0 * (a - b) + da + db;
    return {a + s * (da + s * (c2 + s * c3)), (da + s * (2.0 * c2 + 3.0 * s * c3)) / h,
            (2.0 * c2 + 6.0 * s * c3) / (h * h)};
}

LatheSurface::LatheSurface(const Lathe& lathe) : shape_(lathe), axis_(glm::normalize(lathe.axis)) {
    const glm::dvec3 from = std::abs(axis_.z) > 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 0, 1);
    u_ = glm::normalize(from - glm::dot(from, axis_) * axis_);
    v_ = glm::cross(axis_, u_);
    for (const std::vector<glm::dvec2>& part : partsOf(lathe.profile)) runs_.push_back(splined(part));
    for (std::size_t r = 0; r < runs_.size(); ++r) {
        const Run& run = runs_[r];
        for (std::size_t i = 0; i + 1 < run.knots.size(); ++i)
            for (int k = 0; k < guidesPerSegment; ++k) {
                const double t = run.knots[i] + (run.knots[i + 1] - run.knots[i]) * k / guidesPerSegment;
                guides_.push_back({r, t, sample(run, t).at});
            }
        guides_.push_back({r, run.knots.back(), run.points.back()});
    }
}

LatheSurface::Point LatheSurface::nearest(const glm::dvec3& p) const {
    const glm::dvec3 d = p - shape_.foot;
    const glm::dvec2 across(glm::dot(d, u_), glm::dot(d, v_));
    const double radius = glm::length(across);
    const glm::dvec2 q(radius, glm::dot(d, axis_));
    std::size_t best = 0;
    double least = INFINITY;
    for (std::size_t i = 0; i < guides_.size(); ++i) {
        const glm::dvec2 apart = guides_[i].at - q;
        if (glm::dot(apart, apart) < least) least = glm::dot(apart, apart), best = i;
    }
    // Newton's steps on the distance's derivative, kept within the guide's neighbours.
    const Run& run = runs_[guides_[best].run];
    const double length = run.knots.back();
    const bool firstOfRun = best == 0 || guides_[best - 1].run != guides_[best].run;
    const bool lastOfRun = best + 1 == guides_.size() || guides_[best + 1].run != guides_[best].run;
    double t = guides_[best].t;
    const double first = guides_[firstOfRun ? best + 1 : best - 1].t,
                 last = guides_[lastOfRun ? best - 1 : best + 1].t;
    double low = firstOfRun ? (run.closed ? t - (first - t) : 0) : first;
    double high = lastOfRun ? (run.closed ? t + (t - last) : length) : last;
    const auto slopeAt = [&](const CurvePoint& c) { return glm::dot(c.at - q, c.first); };
    CurvePoint c = sample(run, t);
    for (int k = 0; k < 60; ++k) {
        const double slope = slopeAt(c);
        (slope > 0 ? high : low) = t;
        const double bend = glm::dot(c.first, c.first) + glm::dot(c.at - q, c.second);
        double next = t - slope / bend;
        if (!(bend > 0 && next >= low && next <= high)) next = 0.5 * (low + high);
        const bool done = std::abs(next - t) <= 1e-16 * length;
        t = next;
        c = sample(run, t);
        if (done) break;
    }
    const glm::dvec2 out = radius > 0 ? across / radius : glm::dvec2(1, 0);
    const glm::dvec3 outward = out.x * u_ + out.y * v_;
    const glm::dvec2 normal = glm::normalize(glm::dvec2(c.first.y, -c.first.x));
    double angle = std::atan2(out.y, out.x);
    angle -= turn * std::floor((angle - shape_.from) / turn);
    Point point;
    point.position = shape_.foot + c.at.x * outward + c.at.y * axis_;
    point.normal = normal.x * outward + normal.y * axis_;
    const auto atFreeEnd = [&] {
        const bool start = guides_[best].run == 0 && t <= 1e-9 * length;
        const bool end = guides_[best].run + 1 == runs_.size() && t >= (1 - 1e-9) * length;
        return !run.closed &&
               ((start && shape_.profile.front().x > 0) || (end && shape_.profile.back().x > 0));
    };
    point.within = angle <= shape_.to && !atFreeEnd();
    return point;
}

LitMesh LatheSurface::mesh(const glm::vec3& colour, const glm::vec3& second) const {
    LitMesh mesh;
    const bool whole = shape_.to - shape_.from > turn * (1 - 1e-12);
    const auto around = static_cast<std::uint32_t>(shape_.slices + (whole ? 0 : 1));
    for (std::size_t r = 0; r < runs_.size(); ++r) {
        const Run& run = runs_[r];
        struct Ring {
            std::uint32_t first;
            bool pole;
            std::uint32_t at(std::uint32_t i, std::uint32_t count) const {
                return pole ? first : first + i % count;
            }
        };
        std::vector<Ring> rings;
        const auto add = [&](double t, bool pole) {
            CurvePoint c = sample(run, t);
            if (pole) c.at.x = 0;
            rings.push_back({static_cast<std::uint32_t>(mesh.corners.size()), pole});
            const double length = glm::length(c.first);
            // Said by a normal without a direction (latheProblem).
            const bool bad = !(length > 0) || (!pole && !(c.at.x > 0));
            const glm::dvec2 n = bad ? glm::dvec2(0) : glm::dvec2(c.first.y, -c.first.x) / length;
            for (std::uint32_t i = 0; i < (pole ? 1 : around); ++i) {
                const double angle = shape_.from + (shape_.to - shape_.from) * i / shape_.slices;
                const glm::dvec3 out = std::cos(angle) * u_ + std::sin(angle) * v_;
                mesh.corners.push_back({glm::vec3(shape_.foot + c.at.x * out + c.at.y * axis_),
                                        glm::vec3((pole ? 0 : n.x) * out + n.y * axis_),
                                        r % 2 == 0 ? colour : second});
            }
        };
        const std::size_t segments = run.knots.size() - 1;
        for (std::size_t i = 0; i < segments; ++i)
            for (int k = 0; k < shape_.steps; ++k)
                add(run.knots[i] + (run.knots[i + 1] - run.knots[i]) * k / shape_.steps,
                    i == 0 && k == 0 && run.points.front().x == 0);
        if (run.closed)
            rings.push_back(rings.front());
        else
            add(run.knots.back(), run.points.back().x == 0);
        for (std::size_t j = 0; j + 1 < rings.size(); ++j)
            for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(shape_.slices); ++i) {
                const std::uint32_t a = rings[j].at(i, around), b = rings[j].at(i + 1, around),
                                    c = rings[j + 1].at(i + 1, around), d = rings[j + 1].at(i, around);
                if (!rings[j].pole) mesh.indices.insert(mesh.indices.end(), {a, b, c});
                if (!rings[j + 1].pole) mesh.indices.insert(mesh.indices.end(), {a, c, d});
            }
    }
    return mesh;
}

}  // namespace app
