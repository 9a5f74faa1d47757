#include "city/terrain/Rasterise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "city/terrain/WholeCells.h"

namespace city {

namespace {

void raise(Heightfield& field, int i, int j, double z) {
    const float height = static_cast<float>(z);
    if (!(field.at(i, j) >= height)) field.set(i, j, height);
}

/// Cells [first, last] of one axis, empty when first > last.
struct Range {
    int first;
    int last;
};

/// Cells whose centre lies in [low, high]; coordinates in cells from the grid's corner.
Range centresIn(double low, double high, int cells) {
    const double first = std::ceil(low - 0.5);
    const double last = std::floor(high - 0.5);
    return {first > 0 ? (first < cells ? static_cast<int>(first) : cells) : 0,
            last < cells - 1 ? (last >= 0 ? static_cast<int>(last) : -1) : cells - 1};
}

void rasteriseCentres(const GridTriangle& tri, Heightfield& field) {
    // Corners by y; every edge is then walked from its lower end, the same way for both triangles that share
    // it.
    std::array<glm::dvec3, 3> p = tri.corner;
    std::sort(p.begin(), p.end(),
              [](const glm::dvec3& a, const glm::dvec3& b) { return a.y != b.y ? a.y < b.y : a.x < b.x; });
    const double area = tri.signedArea2();
    if (area == 0) return;
    const glm::dvec2 slope = tri.slope();
    const auto zRange = std::minmax({p[0].z, p[1].z, p[2].z});
    const Range rows = centresIn(p[0].y, p[2].y, field.height());
    const auto crossing = [](const glm::dvec3& low, const glm::dvec3& high, double y) {
        const double x = low.x + (high.x - low.x) * ((y - low.y) / (high.y - low.y));
        return std::clamp(x, std::min(low.x, high.x), std::max(low.x, high.x));
    };
    for (int j = rows.first; j <= rows.last; ++j) {
        const double y = j + 0.5;
        double left = std::numeric_limits<double>::infinity();
        double right = -left;
        const auto widen = [&](double x) {
            left = std::min(left, x);
            right = std::max(right, x);
        };
        const auto edge = [&](const glm::dvec3& low, const glm::dvec3& high) {
            if (y < low.y || y > high.y) return;
            if (low.y == high.y) {
                widen(low.x);
                widen(high.x);
            } else {
                widen(crossing(low, high, y));
            }
        };
        edge(p[0], p[1]);
        edge(p[1], p[2]);
        edge(p[0], p[2]);
        const Range columns = centresIn(left, right, field.width());
        for (int i = columns.first; i <= columns.last; ++i) {
            // Slivers seen edge-on have slopes that magnify rounding: keep within the corners' heights.
            const double z = p[0].z + slope.x * (i + 0.5 - p[0].x) + slope.y * (y - p[0].y);
            raise(field, i, j, std::clamp(z, zRange.first, zRange.second));
        }
    }
}

/// Highest point of the convex polygon's part with low <= coordinate <= high is found by clipping.
using Polygon = std::vector<glm::dvec3>;

void clip(const Polygon& in, int axis, double limit, double side, Polygon& out) {
    out.clear();
    for (std::size_t k = 0; k < in.size(); ++k) {
        const glm::dvec3& a = in[k];
        const glm::dvec3& b = in[(k + 1) % in.size()];
        const double da = side * (a[axis] - limit);
        const double db = side * (b[axis] - limit);
        if (da >= 0) out.push_back(a);
        if ((da > 0 && db < 0) || (da < 0 && db > 0)) {
            glm::dvec3 c = a + (b - a) * (da / (da - db));
            c[axis] = limit;
            out.push_back(c);
        }
    }
}

Range cellsTouched(double low, double high, int cells) {
    // A polygon that only touches a border from outside lies in the next cell under the half-open rule; that
    // cell is in the range, and the one before it is not.
    const double first = std::floor(low);
    const double last = high > low ? std::ceil(high) - 1 : first;
    return {first > 0 ? (first < cells ? static_cast<int>(first) : cells) : 0,
            last < cells - 1 ? (last >= 0 ? static_cast<int>(last) : -1) : cells - 1};
}

struct ClipSpace {
    Polygon band, cell, scratch;
};

void rasteriseAny(const GridTriangle& tri, Heightfield& field, ClipSpace& space) {
    const auto [lowX, highX] = std::minmax({tri.corner[0].x, tri.corner[1].x, tri.corner[2].x});
    const auto [lowY, highY] = std::minmax({tri.corner[0].y, tri.corner[1].y, tri.corner[2].y});
    const double top = std::max({tri.corner[0].z, tri.corner[1].z, tri.corner[2].z});
    const Range rows = cellsTouched(lowY, highY, field.height());
    const Range columns = cellsTouched(lowX, highX, field.width());
    if (rows.first == rows.last && columns.first == columns.last &&
        std::floor(lowX) == std::ceil(highX) - 1 && std::floor(lowY) == std::ceil(highY) - 1)
        return raise(field, columns.first, rows.first, top);
    for (int j = rows.first; j <= rows.last; ++j) {
        const Polygon corners(tri.corner.begin(), tri.corner.end());
        clip(corners, 1, j, 1, space.scratch);
        clip(space.scratch, 1, j + 1, -1, space.band);
        if (space.band.empty()) continue;
        double left = space.band[0].x, right = left;
        for (const glm::dvec3& p : space.band) {
            left = std::min(left, p.x);
            right = std::max(right, p.x);
        }
        const Range inBand = cellsTouched(left, right, field.width());
        for (int i = inBand.first; i <= inBand.last; ++i) {
            clip(space.band, 0, i, 1, space.scratch);
            clip(space.scratch, 0, i + 1, -1, space.cell);
            if (space.cell.empty()) continue;
            double z = space.cell[0].z;
            for (const glm::dvec3& p : space.cell) z = std::max(z, p.z);
            raise(field, i, j, z);
        }
    }
}

}  // namespace

void rasterise(const Mesh& mesh, const glm::mat4& transform, Coverage coverage, Heightfield& field) {
    const glm::dmat4 worldFromMesh(transform);
    const double perCell = 1.0 / static_cast<double>(field.cellSize());
    std::vector<glm::dvec3> grid(mesh.vertices.size());
    for (std::size_t k = 0; k < grid.size(); ++k) {
        const glm::dvec3 world(worldFromMesh * glm::dvec4(glm::dvec3(mesh.vertices[k].position), 1));
        grid[k] = {(world.x - field.origin().x) * perCell, (world.y - field.origin().y) * perCell, world.z};
    }
    ClipSpace space;
    WholeCells wholeCells(field);
    const double width = field.width();
    const double height = field.height();
    for (std::size_t k = 0; k + 2 < mesh.indices.size(); k += 3) {
        GridTriangle tri;
        bool usable = true;
        for (std::size_t c = 0; c < 3; ++c) {
            const std::uint32_t index = mesh.indices[k + c];
            usable = usable && index < grid.size();
            if (!usable) break;
            tri.corner[c] = grid[index];
            usable = std::isfinite(tri.corner[c].x) && std::isfinite(tri.corner[c].y) &&
                     std::isfinite(tri.corner[c].z);
        }
        if (!usable) continue;
        const auto& p = tri.corner;
        if (std::max({p[0].x, p[1].x, p[2].x}) < 0 || std::min({p[0].x, p[1].x, p[2].x}) > width ||
            std::max({p[0].y, p[1].y, p[2].y}) < 0 || std::min({p[0].y, p[1].y, p[2].y}) > height)
            continue;
        switch (coverage) {
            case Coverage::centre:
                rasteriseCentres(tri, field);
                break;
            case Coverage::any:
                rasteriseAny(tri, field, space);
                break;
            case Coverage::whole:
                wholeCells.add(tri);
                break;
        }
    }
    if (coverage == Coverage::whole) wholeCells.raise(field);
}

}  // namespace city
