#include "city/terrain/WholeCells.h"

#include <algorithm>
#include <cmath>

namespace city {

namespace {

/// Share of a cell's area that may stay uncovered: rounding leaves slivers of about 1e-13 along shared edges.
constexpr double forgivenArea = 1e-6;

using Polygon = std::vector<glm::dvec2>;

double area(const Polygon& p) {
    double twice = 0;
    for (std::size_t k = 1; k + 1 < p.size(); ++k) {
        const glm::dvec2 a = p[k] - p[0];
        const glm::dvec2 b = p[k + 1] - p[0];
        twice += a.x * b.y - a.y * b.x;
    }
    return 0.5 * std::abs(twice);
}

double side(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& p) {
    return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
}

/// Splits a convex polygon by the line a-b.
void split(const Polygon& in, const glm::dvec2& a, const glm::dvec2& b, Polygon& left, Polygon& right) {
    left.clear();
    right.clear();
    for (std::size_t k = 0; k < in.size(); ++k) {
        const glm::dvec2& p = in[k];
        const glm::dvec2& q = in[(k + 1) % in.size()];
        const double sp = side(a, b, p);
        const double sq = side(a, b, q);
        if (sp >= 0) left.push_back(p);
        if (sp <= 0) right.push_back(p);
        if ((sp > 0 && sq < 0) || (sp < 0 && sq > 0)) {
            const glm::dvec2 cut = p + (q - p) * (sp / (sp - sq));
            left.push_back(cut);
            right.push_back(cut);
        }
    }
}

std::array<glm::dvec2, 3> counterClockwise(const GridTriangle& triangle) {
    std::array<glm::dvec2, 3> c{glm::dvec2(triangle.corner[0]), glm::dvec2(triangle.corner[1]),
                                glm::dvec2(triangle.corner[2])};
    if (triangle.signedArea2() < 0) std::swap(c[1], c[2]);
    return c;
}

/// The cell's part inside the triangle.
Polygon overlap(const GridTriangle& triangle, const Polygon& square) {
    const auto c = counterClockwise(triangle);
    Polygon inside = square, left, right;
    for (std::size_t e = 0; e < 3 && inside.size() >= 3; ++e) {
        split(inside, c[e], c[(e + 1) % 3], left, right);
        inside.swap(left);
    }
    return inside;
}

/// Takes the triangle out of the convex pieces; what is left is again convex pieces.
void subtract(const GridTriangle& triangle, std::vector<Polygon>& pieces) {
    const auto c = counterClockwise(triangle);
    std::vector<Polygon> left;
    for (Polygon& piece : pieces) {
        Polygon inside = std::move(piece), in, out;
        for (std::size_t e = 0; e < 3 && inside.size() >= 3; ++e) {
            split(inside, c[e], c[(e + 1) % 3], in, out);
            if (out.size() >= 3 && area(out) > 0) left.push_back(out);
            inside.swap(in);
        }
    }
    pieces.swap(left);
}

double coverHeight(std::vector<std::pair<double, const GridTriangle*>>& layers, const Polygon& square) {
    std::sort(layers.begin(), layers.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
    std::vector<Polygon> open{square};
    for (const auto& [lowest, triangle] : layers) {
        subtract(*triangle, open);
        double uncovered = 0;
        for (const Polygon& piece : open) uncovered += area(piece);
        if (uncovered <= forgivenArea) return lowest;
    }
    return -std::numeric_limits<double>::infinity();
}

}  // namespace

void WholeCells::add(const GridTriangle& triangle) {
    if (triangle.signedArea2() == 0) return;
    const auto& p = triangle.corner;
    const auto cells = [](double low, double high, int count) {
        return std::pair(static_cast<int>(std::clamp(std::floor(low), 0.0, static_cast<double>(count))),
                         static_cast<int>(std::clamp(std::ceil(high), 0.0, static_cast<double>(count))));
    };
    const auto index = static_cast<std::uint32_t>(triangles_.size());
    triangles_.push_back(triangle);
    // Row by row, only the columns between the triangle's extremes in that row.
    const auto [j0, j1] =
        cells(std::min({p[0].y, p[1].y, p[2].y}), std::max({p[0].y, p[1].y, p[2].y}), height_);
    for (int j = j0; j < j1; ++j) {
        double left = std::numeric_limits<double>::infinity();
        double right = -left;
        for (std::size_t e = 0; e < 3; ++e) {
            const glm::dvec3& a = p[e];
            const glm::dvec3& b = p[(e + 1) % 3];
            if (std::max(a.y, b.y) < j || std::min(a.y, b.y) > j + 1) continue;
            for (const double y : {static_cast<double>(j), static_cast<double>(j + 1)}) {
                const double s = a.y == b.y ? 0 : std::clamp((y - a.y) / (b.y - a.y), 0.0, 1.0);
                const double x = a.x + s * (b.x - a.x);
                left = std::min(left, x);
                right = std::max(right, x);
            }
            if (a.y == b.y) {
                left = std::min(left, b.x);
                right = std::max(right, b.x);
            }
        }
        if (left > right) continue;
        const auto [i0, i1] = cells(left, right, width_);
        for (int i = i0; i < i1; ++i)
            pairs_.push_back({static_cast<std::uint64_t>(j) * static_cast<std::uint64_t>(width_) +
                                  static_cast<std::uint64_t>(i),
                              index});
    }
}

void WholeCells::raise(Heightfield& field) const {
    std::vector<Pair> pairs = pairs_;
    std::stable_sort(pairs.begin(), pairs.end(),
                     [](const Pair& a, const Pair& b) { return a.cell < b.cell; });
    std::vector<std::pair<double, const GridTriangle*>> layers;
    for (std::size_t first = 0; first < pairs.size();) {
        std::size_t last = first;
        while (last < pairs.size() && pairs[last].cell == pairs[first].cell) ++last;
        const int i = static_cast<int>(pairs[first].cell % static_cast<std::uint64_t>(width_));
        const int j = static_cast<int>(pairs[first].cell / static_cast<std::uint64_t>(width_));
        const double x = i, y = j;
        const Polygon square{{x, y}, {x + 1, y}, {x + 1, y + 1}, {x, y + 1}};
        layers.clear();
        for (std::size_t k = first; k < last; ++k) {
            const GridTriangle& triangle = triangles_[pairs[k].triangle];
            const Polygon part = overlap(triangle, square);
            if (part.size() < 3) continue;
            const glm::dvec2 slope = triangle.slope();
            const glm::dvec3& foot = triangle.corner[0];
            double lowest = std::numeric_limits<double>::infinity();
            for (const glm::dvec2& p : part)
                lowest = std::min(lowest, foot.z + slope.x * (p.x - foot.x) + slope.y * (p.y - foot.y));
            const double floor = std::min({triangle.corner[0].z, triangle.corner[1].z, triangle.corner[2].z});
            layers.emplace_back(std::max(lowest, floor), &triangle);
        }
        const double z = coverHeight(layers, square);
        if (std::isfinite(z)) {
            float height = static_cast<float>(z);
            if (static_cast<double>(height) > z)  // never above the surface
                height = std::nextafter(height, -std::numeric_limits<float>::infinity());
            if (!(field.at(i, j) >= height)) field.set(i, j, height);
        }
        first = last;
    }
}

}  // namespace city
