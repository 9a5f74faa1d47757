#include "reflection/chrome/ReflectorMap.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "reflection/reference_maps/CubeMapping.h"

namespace reflection {

namespace {

struct FacePoint {
    std::size_t face;
    double s, t;
};

/// cubePoint in double precision.
FacePoint facePointOf(const glm::dvec3& d) {
    const double ax = std::abs(d.x), ay = std::abs(d.y), az = std::abs(d.z);
    std::size_t face = 0;
    double major = ax;
    if (ax >= ay && ax >= az) {
        face = d.x < 0 ? 1 : 0;
    } else if (ay >= az) {
        face = d.y < 0 ? 3 : 2;
        major = ay;
    } else {
        face = d.z < 0 ? 5 : 4;
        major = az;
    }
    if (!(major > 0)) return {0, 0, 0};
    const glm::dvec3 s(cubeFaces[face].sAxis), t(cubeFaces[face].tAxis);
    return {face, glm::dot(s, d) / major, glm::dot(t, d) / major};
}

glm::dvec3 cubeSurface(std::size_t face, double s, double t) {
    const CubeFace& f = cubeFaces[face];
    return glm::dvec3(f.major) + s * glm::dvec3(f.sAxis) + t * glm::dvec3(f.tAxis);
}

}  // namespace

glm::dvec3 ReflectorMap::cornerPoint(int cells, int face, int column, int row) {
    return cubeSurface(static_cast<std::size_t>(face), 2.0 * column / cells - 1, 2.0 * row / cells - 1);
}

ReflectorMap::ReflectorMap(int cellsPerSide, Bend bend, const MapFrame& frame, std::vector<Corner> corners,
                           std::vector<std::uint8_t> covered)
    : cells(cellsPerSide),
      curvature(bend),
      place(frame),
      values(std::move(corners)),
      own(std::move(covered)) {
    whole = std::all_of(own.begin(), own.end(), [](std::uint8_t c) { return c != 0; });
    findRadii();
    byNormal = indexNormals(false);
    if (!whole) {
        byCoveredNormal = indexNormals(true);
        findRim();
    }
    balls = SurfacePatches(*this);
}

double ReflectorMap::coveredShare(const glm::dvec3& direction) const {
    const FacePoint at = facePointOf(direction / place.stretch);
    const double x = (at.s + 1) * 0.5 * cells, y = (at.t + 1) * 0.5 * cells;
    const int column = std::clamp(static_cast<int>(x), 0, cells - 1);
    const int row = std::clamp(static_cast<int>(y), 0, cells - 1);
    const double u = x - column, v = y - row;
    const std::size_t first = cornerIndex(cells, static_cast<int>(at.face), column, row);
    const std::size_t below = first + static_cast<std::size_t>(cells + 1);
    return (1 - v) * ((1 - u) * own[first] + u * own[first + 1]) +
           v * ((1 - u) * own[below] + u * own[below + 1]);
}

ReflectorMap::Sample ReflectorMap::sample(const glm::dvec3& direction) const {
    const glm::dvec3 inCube = direction / place.stretch;
    const FacePoint at = facePointOf(inCube);
    const glm::dvec3 g = cubeSurface(at.face, at.s, at.t);
    const double x = (at.s + 1) * 0.5 * cells, y = (at.t + 1) * 0.5 * cells;
    const int column = std::clamp(static_cast<int>(x), 0, cells - 1);
    const int row = std::clamp(static_cast<int>(y), 0, cells - 1);
    const double u = x - column, v = y - row;
    glm::dvec3 normal(0);
    double q = 0, cover = 0;
    for (int k = 0; k < 4; ++k) {
        const int i = column + (k & 1), j = row + (k >> 1);
        const double w = ((k & 1) != 0 ? u : 1 - u) * ((k >> 1) != 0 ? v : 1 - v);
        const std::size_t index = cornerIndex(cells, static_cast<int>(at.face), i, j);
        const glm::dvec4 c(values[index]);
        const glm::dvec3 m(c);
        normal += w * m;
        q += w * 0.5 * c.w * glm::dot(m, cornerPoint(cells, static_cast<int>(at.face), i, j) + g);
        cover += w * own[index];
    }
    Sample result;
    result.position = place.stretch * g / q;
    result.normal = glm::normalize(normal / place.stretch);
    const double largest = std::max({std::abs(inCube.x), std::abs(inCube.y), std::abs(inCube.z)});
    result.gauge = largest * q;
    result.covered = cover >= 0.5;
    return result;
}

void ReflectorMap::findRim() {
    const auto isOwn = [&](int face, int column, int row) {
        return own[cornerIndex(cells, face, column, row)] != 0;
    };
    for (int face = 0; face < 6; ++face)
        for (int row = 0; row < cells; ++row)
            for (int column = 0; column < cells; ++column) {
                int count = 0;
                for (int k = 0; k < 4; ++k) count += isOwn(face, column + (k & 1), row + (k >> 1));
                if (count == 0 || count == 4) continue;
                for (int k = 0; k < 4; ++k) {
                    const int i = column + (k & 1), j = row + (k >> 1);
                    if (isOwn(face, i, j))
                        rim.emplace_back(sample(place.stretch * cornerPoint(cells, face, i, j)).position /
                                         place.stretch);
                }
            }
}

double ReflectorMap::fromRim(const glm::dvec3& point) const {
    const glm::vec3 at(point / place.stretch);
    float nearest = std::numeric_limits<float>::infinity();
    for (const glm::vec3& r : rim) {
        const glm::vec3 d = r - at;
        nearest = std::min(nearest, glm::dot(d, d));
    }
    return std::sqrt(static_cast<double>(nearest));
}

void ReflectorMap::findRadii() {
    inner = std::numeric_limits<double>::max();
    outer = 0;
    for (int face = 0; face < 6; ++face)
        for (int row = 0; row <= cells; ++row)
            for (int column = 0; column <= cells; ++column) {
                const glm::dvec3 g = cornerPoint(cells, face, column, row);
                const double radius = glm::length(sample(place.stretch * g).position / place.stretch);
                inner = std::min(inner, radius);
                outer = std::max(outer, radius);
            }
    if (cells == 0) inner = 0;
}

std::vector<glm::vec3> ReflectorMap::indexNormals(bool coveredOnly) const {
    std::vector<glm::vec3> table;
    if (cells == 0) return table;
    // Every other corner (at most 24 to a side) competes for every texel of the table.
    const int step = std::max(1, cells / 24);
    struct Entry {
        glm::vec3 normal, direction;
    };
    std::vector<Entry> entries;
    for (int face = 0; face < 6; ++face)
        for (int row = 0; row <= cells; row += step)
            for (int column = 0; column <= cells; column += step) {
                const std::size_t index = cornerIndex(cells, face, column, row);
                if (coveredOnly && own[index] == 0) continue;
                entries.push_back({glm::normalize(glm::vec3(values[index]) / glm::vec3(place.stretch)),
                                   glm::vec3(cornerPoint(cells, face, column, row))});
            }
    if (entries.empty()) return table;
    table.resize(6 * static_cast<std::size_t>(normalTableSide) * normalTableSide);
    std::size_t at = 0;
    for (int face = 0; face < 6; ++face)
        for (int row = 0; row < normalTableSide; ++row)
            for (int column = 0; column < normalTableSide; ++column, ++at) {
                const glm::vec3 wanted =
                    glm::normalize(cubeDirection(face, glm::vec2(column, row) + 0.5f, normalTableSide));
                float best = -2;
                for (const Entry& e : entries) {
                    const float cosine = glm::dot(wanted, e.normal);
                    if (cosine > best) {
                        best = cosine;
                        table[at] = e.direction;
                    }
                }
            }
    return table;
}

glm::dvec3 ReflectorMap::directionOfNormal(const glm::dvec3& normal) const {
    const FacePoint at = facePointOf(normal);
    const auto texel = [](double x) {
        return static_cast<std::size_t>(
            std::clamp(static_cast<int>((x + 1) * 0.5 * normalTableSide), 0, normalTableSide - 1));
    };
    return place.stretch *
           glm::dvec3(byNormal[(at.face * normalTableSide + texel(at.t)) * normalTableSide + texel(at.s)]);
}

}  // namespace reflection
