#include "reflection/chrome/BuildReflectorMap.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "reflection/chrome/CloseReflector.h"
#include "reflection/chrome/CubeLattice.h"
#include "reflection/reference_maps/CubeMapping.h"

namespace reflection {

namespace {

/// Two layers nearer to each other than this share of their distance are one: neighbouring triangles both
/// claim the corners on their common edge.
constexpr double sameLayer = 1e-6;

/// A corner of the map that lies on a corner of the mesh is outside all its triangles if rounding says so
/// (about 1e-16); this much outside still counts as on the edge.
constexpr double onTheEdge = 1e-12;

struct Corner3 {
    glm::dvec3 position, normal;
};
using Triangle = std::array<Corner3, 3>;

bool finite(const glm::dvec3& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

/// A direction's place on a triangle that its ray meets: barycentric weights in proportion to the volumes
/// that the direction spans with the opposite sides, seen from the centre.
struct Cone {
    glm::dvec3 a, b, c;  ///< b x c, c x a, a x b, turned so that the inside is positive

    static Cone of(const Triangle& t, double sign) {
        return {sign * glm::cross(t[1].position, t[2].position),
                sign * glm::cross(t[2].position, t[0].position),
                sign * glm::cross(t[0].position, t[1].position)};
    }
    glm::dvec3 weights(const glm::dvec3& g) const { return {glm::dot(a, g), glm::dot(b, g), glm::dot(c, g)}; }
};

struct Rectangle {
    int left, top, right, bottom;  ///< inclusive
};

/// The corners of a face that may see the triangle; the whole face where the triangle reaches behind it.
bool rectangleOn(const CubeFace& face, const Triangle& t, int cells, Rectangle& to) {
    const glm::dvec3 major(face.major), s(face.sAxis), u(face.tAxis);
    double lowS = 1, highS = -1, lowT = 1, highT = -1;
    int behind = 0;
    for (const Corner3& c : t) {
        const double depth = glm::dot(major, c.position);
        if (depth <= 0) {
            ++behind;
            continue;
        }
        const double x = glm::dot(s, c.position) / depth, y = glm::dot(u, c.position) / depth;
        lowS = std::min(lowS, x), highS = std::max(highS, x);
        lowT = std::min(lowT, y), highT = std::max(highT, y);
    }
    if (behind == 3) return false;
    if (behind > 0) lowS = lowT = -1, highS = highT = 1;
    const auto corner = [cells](double x) {
        return static_cast<int>(std::clamp((x + 1) * 0.5 * cells, -1.0, cells + 1.0));
    };
    to = {std::max(corner(lowS) - 1, 0), std::max(corner(lowT) - 1, 0), std::min(corner(highS) + 1, cells),
          std::min(corner(highT) + 1, cells)};
    return to.left <= to.right && to.top <= to.bottom;
}

void measure(const ReflectorMap& map, const std::vector<Triangle>& triangles, double sign,
             ReflectorMapReport& report) {
    std::size_t n = 0;
    const auto compare = [&](const glm::dvec3& position, const glm::dvec3& stretched) {
        const glm::dvec3 normal = stretched / map.frame().stretch;
        const double length = glm::length(normal);
        if (!(length > 0) || !(glm::dot(position, position) > 0)) return;
        const glm::dvec3& stretch = map.frame().stretch;
        const ReflectorMap::Sample s = map.sample(stretch * position);
        const double distance = glm::length(s.position - stretch * position) * map.frame().scale;
        // atan2 keeps its accuracy at small angles.
        const double angle = std::atan2(glm::length(glm::cross(s.normal, normal)) / length,
                                        glm::dot(s.normal, normal) / length);
        report.worstDistance = std::max(report.worstDistance, distance);
        report.worstAngle = std::max(report.worstAngle, angle);
        report.meanDistance += distance;
        report.meanAngle += angle;
        ++n;
    };
    for (const Triangle& t : triangles) {
        const glm::dvec3 front = glm::cross(t[1].position - t[0].position, t[2].position - t[0].position);
        if (!(sign * glm::dot(front, t[0].position) > 0)) continue;
        compare((t[0].position + t[1].position + t[2].position) / 3.0,
                t[0].normal + t[1].normal + t[2].normal);
        for (const Corner3& c : t) compare(c.position, c.normal);
    }
    if (n > 0) {
        report.meanDistance /= static_cast<double>(n);
        report.meanAngle /= static_cast<double>(n);
    }
}

}  // namespace

BuiltReflectorMap buildReflectorMap(const city::Mesh& piece, const glm::dvec3& centre, Bend bend, int cells) {
    MapFrame frame;
    frame.centre = centre;
    return buildReflectorMap(piece, frame, bend == Bend::convex, bend, cells);
}

BuiltReflectorMap buildReflectorMap(const city::Mesh& piece, const MapFrame& asked, bool behind, Bend bend,
                                    int cells) {
    BuiltReflectorMap result;
    const double longest = std::max({asked.stretch.x, asked.stretch.y, asked.stretch.z});
    const double shortest = std::min({asked.stretch.x, asked.stretch.y, asked.stretch.z});
    if (cells < 1 || !finite(asked.centre) || !finite(asked.stretch) || !(shortest > 0)) return result;
    const double sign = behind ? 1.0 : -1.0;

    MapFrame frame = asked;
    frame.stretch /= longest;
    frame.scale = 1;
    double scale = 0;
    for (const city::Vertex& v : piece.vertices)
        if (finite(glm::dvec3(v.position)))
            scale = std::max(scale, glm::length(frame.toMap(glm::dvec3(v.position)) / frame.stretch));
    if (!(scale > 0)) return result;
    frame.scale = scale;

    std::vector<Triangle> triangles;
    for (std::size_t k = 0; k + 2 < piece.indices.size(); k += 3) {
        Triangle t;
        bool usable = true;
        for (std::size_t i = 0; i < 3; ++i) {
            const city::Vertex& v = piece.vertices[piece.indices[k + i]];
            // Normals go with the reciprocal of what positions go with.
            t[i] = {frame.toMap(glm::dvec3(v.position)) / frame.stretch,
                    frame.toMapDirection(glm::dvec3(v.normal)) * frame.stretch};
            usable = usable && finite(t[i].position) && finite(t[i].normal);
        }
        if (usable)
            triangles.push_back(t);
        else
            ++result.report.skipped;
    }

    const CubeLattice lattice(cells);
    std::vector<ReflectorCorner> corners(lattice.size());
    std::vector<std::uint8_t> doubled(lattice.size(), 0);
    for (const Triangle& t : triangles) {
        const double volume = glm::dot(t[0].position, glm::cross(t[1].position, t[2].position));
        if (!(sign * volume > 0)) {
            ++result.report.skipped;
            continue;
        }
        const Cone cone = Cone::of(t, sign);
        for (int face = 0; face < 6; ++face) {
            Rectangle r;
            if (!rectangleOn(cubeFaces[static_cast<std::size_t>(face)], t, cells, r)) continue;
            for (int row = r.top; row <= r.bottom; ++row)
                for (int column = r.left; column <= r.right; ++column) {
                    const std::uint32_t id =
                        lattice.ofCorner(ReflectorMap::cornerIndex(cells, face, column, row));
                    const glm::dvec3& g = lattice.point(id);
                    glm::dvec3 w = cone.weights(g);
                    const double sum = w.x + w.y + w.z;
                    const double outside = -onTheEdge * sum;
                    if (w.x < outside || w.y < outside || w.z < outside || !(sum > 0)) continue;
                    w = glm::max(w / sum, glm::dvec3(0));
                    w /= w.x + w.y + w.z;
                    const glm::dvec3 p = w.x * t[0].position + w.y * t[1].position + w.z * t[2].position;
                    const double q = glm::dot(g, g) / glm::dot(g, p);
                    ReflectorCorner& c = corners[id];
                    if (c.covered && std::abs(c.reciprocal - q) > sameLayer * q) doubled[id] = 1;
                    if (c.covered && c.reciprocal <= q) continue;
                    const glm::dvec3 n = w.x * t[0].normal + w.y * t[1].normal + w.z * t[2].normal;
                    const double length = glm::length(n);
                    c.covered = true;
                    c.reciprocal = q;
                    c.normal = length > 0 ? n / length : sign * glm::normalize(g);
                }
        }
    }
    for (const std::uint8_t d : doubled) result.report.overlapping += d;

    const ClosedReflector closed = closeReflector(
        lattice, corners, sign, behind && bend == Bend::convex ? Closing::envelope : Closing::ball, cells);
    if (closed.covered == 0) return result;
    result.report.tilted = closed.tilted;
    result.report.coveredShare = static_cast<double>(closed.covered) / static_cast<double>(lattice.size());
    std::vector<ReflectorMap::Corner> packed(ReflectorMap::cornerCount(cells));
    std::vector<std::uint8_t> own(packed.size());
    for (std::size_t k = 0; k < packed.size(); ++k) {
        const std::uint32_t id = lattice.ofCorner(k);
        const glm::dvec3& g = lattice.point(id);
        const ReflectorCorner& c = corners[id];
        const glm::vec3 m(c.normal * glm::length(g));
        // The reciprocal is taken of the stored normal, so that the corner's own distance is exact to one
        // rounding.
        packed[k] = glm::vec4(m, static_cast<float>(c.reciprocal / glm::dot(glm::dvec3(m), g)));
        own[k] = c.covered ? 1 : 0;
    }
    result.map = ReflectorMap(cells, bend, frame, std::move(packed), std::move(own));
    measure(result.map, triangles, sign, result.report);
    result.status =
        result.report.overlapping > 0 ? ReflectorMapStatus::notStarShaped : ReflectorMapStatus::built;
    return result;
}

}  // namespace reflection
