#include "city/model/PolygonAlgebra.h"

#include <geos_c.h>

#include <algorithm>
#include <cmath>
#include <memory>

namespace city {

namespace {

/// GEOS objects die with their context; each call makes its own, so that calls may run on any thread.
class Geos {
  public:
    Geos() : handle_(GEOS_init_r()) {}
    ~Geos() { GEOS_finish_r(handle_); }
    Geos(const Geos&) = delete;
    Geos& operator=(const Geos&) = delete;
    operator GEOSContextHandle_t() const { return handle_; }

    struct Deleter {
        GEOSContextHandle_t handle;
        void operator()(GEOSGeometry* g) const { GEOSGeom_destroy_r(handle, g); }
    };
    using Geometry = std::unique_ptr<GEOSGeometry, Deleter>;
    Geometry own(GEOSGeometry* g) const { return Geometry(g, Deleter{handle_}); }

  private:
    GEOSContextHandle_t handle_;
};

/// Farther from the origin, neighbouring floats lie a metre apart: no footprint has a shape there. Also false
/// for NaN.
constexpr float farthest = 1e7f;

bool finite(const std::vector<glm::vec2>& ring) {
    return std::all_of(ring.begin(), ring.end(),
                       [](glm::vec2 p) { return std::abs(p.x) <= farthest && std::abs(p.y) <= farthest; });
}

bool finite(const Footprint& footprint) {
    return finite(footprint.outer) && std::all_of(footprint.holes.begin(), footprint.holes.end(),
                                                  [](const auto& h) { return finite(h); });
}

double distanceToSegment(glm::dvec2 p, glm::dvec2 a, glm::dvec2 b) {
    const glm::dvec2 ab = b - a;
    const double lengthSquared = ab.x * ab.x + ab.y * ab.y;
    const double t = lengthSquared > 0
                         ? std::clamp(((p.x - a.x) * ab.x + (p.y - a.y) * ab.y) / lengthSquared, 0.0, 1.0)
                         : 0.0;
    return std::hypot(p.x - a.x - t * ab.x, p.y - a.y - t * ab.y);
}

/// Without repeated corners and corners on a straight line. Every dropped corner stays within the tolerance
/// of the edge that replaces it, however finely a curve is cut.
std::vector<glm::vec2> thinned(const std::vector<glm::vec2>& ring) {
    std::vector<glm::vec2> distinct;
    for (const glm::vec2 p : ring) {
        if (distinct.empty() ||
            std::hypot(double(p.x) - distinct.back().x, double(p.y) - distinct.back().y) > cornerTolerance)
            distinct.push_back(p);
    }
    while (distinct.size() > 1 &&
           std::hypot(double(distinct.front().x) - distinct.back().x,
                      double(distinct.front().y) - distinct.back().y) <= cornerTolerance)
        distinct.pop_back();
    const std::size_t n = distinct.size();
    if (n < 4) return distinct;

    // Start at a corner that surely stays: the lowest, leftmost one is a corner of the convex hull.
    const auto first = std::min_element(distinct.begin(), distinct.end(), [](glm::vec2 a, glm::vec2 b) {
        return a.y != b.y ? a.y < b.y : a.x < b.x;
    });
    std::rotate(distinct.begin(), first, distinct.end());
    std::vector<glm::vec2> kept{distinct.front()};
    std::size_t anchor = 0;
    for (std::size_t i = 1; i < n; ++i) {
        const glm::vec2 next = distinct[(i + 1) % n];
        bool straight = true;
        for (std::size_t k = anchor + 1; k <= i && straight; ++k)
            straight = distanceToSegment(distinct[k], kept.back(), next) <= cornerTolerance;
        if (!straight) {
            kept.push_back(distinct[i]);
            anchor = i;
        }
    }
    return kept;
}

GEOSGeometry* ringGeometry(const Geos& geos, const std::vector<glm::vec2>& ring) {
    const auto n = static_cast<unsigned>(ring.size());
    GEOSCoordSequence* corners = GEOSCoordSeq_create_r(geos, n + 1, 2);
    if (!corners) return nullptr;
    for (unsigned i = 0; i <= n; ++i) GEOSCoordSeq_setXY_r(geos, corners, i, ring[i % n].x, ring[i % n].y);
    return GEOSGeom_createLinearRing_r(geos, corners);
}

/// nullptr for lines that have no two different, finite points.
Geos::Geometry lineGeometry(const Geos& geos, std::span<const glm::vec2> line) {
    std::vector<glm::vec2> points;
    for (const glm::vec2 p : line) {
        if (!(std::abs(p.x) <= farthest && std::abs(p.y) <= farthest)) return geos.own(nullptr);
        if (points.empty() || points.back() != p) points.push_back(p);
    }
    if (points.size() < 2) return geos.own(nullptr);
    GEOSCoordSequence* sequence = GEOSCoordSeq_create_r(geos, static_cast<unsigned>(points.size()), 2);
    if (!sequence) return geos.own(nullptr);
    for (unsigned i = 0; i < points.size(); ++i)
        GEOSCoordSeq_setXY_r(geos, sequence, i, points[i].x, points[i].y);
    return geos.own(GEOSGeom_createLineString_r(geos, sequence));
}

/// nullptr for rings of fewer than three corners.
Geos::Geometry polygonGeometry(const Geos& geos, const Footprint& footprint) {
    if (footprint.outer.size() < 3) return geos.own(nullptr);
    GEOSGeometry* shell = ringGeometry(geos, footprint.outer);
    if (!shell) return geos.own(nullptr);
    std::vector<GEOSGeometry*> holes;
    for (const auto& hole : footprint.holes) {
        if (hole.size() < 3) continue;
        if (GEOSGeometry* g = ringGeometry(geos, hole)) holes.push_back(g);
    }
    return geos.own(GEOSGeom_createPolygon_r(geos, shell, holes.data(), static_cast<unsigned>(holes.size())));
}

std::vector<glm::vec2> ringOf(const Geos& geos, const GEOSGeometry* ring, bool counterClockwise) {
    std::vector<glm::vec2> corners;
    const GEOSCoordSequence* sequence = ring ? GEOSGeom_getCoordSeq_r(geos, ring) : nullptr;
    unsigned n = 0;
    if (!sequence || !GEOSCoordSeq_getSize_r(geos, sequence, &n)) return corners;
    for (unsigned i = 0; i + 1 < n; ++i) {
        double x = 0;
        double y = 0;
        GEOSCoordSeq_getXY_r(geos, sequence, i, &x, &y);
        corners.emplace_back(static_cast<float>(x), static_cast<float>(y));
    }
    corners = thinned(corners);
    if ((signedArea(corners) > 0) != counterClockwise) std::reverse(corners.begin(), corners.end());
    return corners;
}

/// Every polygon within a geometry of any kind.
void collect(const Geos& geos, const GEOSGeometry* geometry, std::vector<Footprint>& out) {
    if (!geometry || GEOSisEmpty_r(geos, geometry) != 0) return;
    const int type = GEOSGeomTypeId_r(geos, geometry);
    if (type == GEOS_POLYGON) {
        Footprint footprint;
        footprint.outer = ringOf(geos, GEOSGetExteriorRing_r(geos, geometry), true);
        if (footprint.outer.size() < 3 || std::abs(signedArea(footprint.outer)) < sliverArea) return;
        for (int i = 0; i < GEOSGetNumInteriorRings_r(geos, geometry); ++i) {
            auto hole = ringOf(geos, GEOSGetInteriorRingN_r(geos, geometry, i), false);
            if (hole.size() >= 3 && std::abs(signedArea(hole)) >= sliverArea)
                footprint.holes.push_back(std::move(hole));
        }
        out.push_back(std::move(footprint));
    } else if (type == GEOS_MULTIPOLYGON || type == GEOS_GEOMETRYCOLLECTION) {
        for (int i = 0; i < GEOSGetNumGeometries_r(geos, geometry); ++i)
            collect(geos, GEOSGetGeometryN_r(geos, geometry, i), out);
    }
}

Geos::Geometry madeValid(const Geos& geos, Geos::Geometry geometry) {
    if (!geometry || GEOSisValid_r(geos, geometry.get()) == 1) return geometry;
    GEOSMakeValidParams* params = GEOSMakeValidParams_create_r(geos);
    GEOSMakeValidParams_setMethod_r(geos, params, GEOS_MAKE_VALID_STRUCTURE);
    GEOSMakeValidParams_setKeepCollapsed_r(geos, params, 0);
    Geos::Geometry valid = geos.own(GEOSMakeValidWithParams_r(geos, geometry.get(), params));
    GEOSMakeValidParams_destroy_r(geos, params);
    return valid;
}

/// The union of footprints, as one geometry.
Geos::Geometry united(const Geos& geos, const std::vector<Footprint>& footprints) {
    std::vector<GEOSGeometry*> pieces;
    for (const Footprint& footprint : footprints) {
        if (!finite(footprint)) continue;
        if (Geos::Geometry valid = madeValid(geos, polygonGeometry(geos, footprint)))
            pieces.push_back(valid.release());
    }
    const Geos::Geometry all = geos.own(GEOSGeom_createCollection_r(
        geos, GEOS_GEOMETRYCOLLECTION, pieces.data(), static_cast<unsigned>(pieces.size())));
    return all ? geos.own(GEOSUnaryUnion_r(geos, all.get())) : geos.own(nullptr);
}

}  // namespace

double signedArea(std::span<const glm::vec2> ring) {
    double twice = 0;
    for (std::size_t i = 2; i < ring.size(); ++i) {
        const glm::dvec2 a = glm::dvec2(ring[i - 1]) - glm::dvec2(ring[0]);
        const glm::dvec2 b = glm::dvec2(ring[i]) - glm::dvec2(ring[0]);
        twice += a.x * b.y - a.y * b.x;
    }
    return twice / 2;
}

double area(const Footprint& footprint) {
    if (!finite(footprint)) return 0;
    double sum = std::abs(signedArea(footprint.outer));
    for (const auto& hole : footprint.holes) sum -= std::abs(signedArea(hole));
    return std::max(sum, 0.0);
}

CleanFootprints cleanFootprint(const Footprint& footprint) {
    CleanFootprints result;
    if (!finite(footprint)) return result;
    Footprint thin{thinned(footprint.outer), {}};
    for (const auto& hole : footprint.holes) thin.holes.push_back(thinned(hole));
    const Geos geos;
    Geos::Geometry geometry = polygonGeometry(geos, thin);
    if (!geometry) return result;
    result.repaired = GEOSisValid_r(geos, geometry.get()) != 1;
    if (result.repaired) geometry = madeValid(geos, std::move(geometry));
    collect(geos, geometry.get(), result.parts);
    return result;
}

std::vector<glm::vec2> triangulateClean(const Footprint& clean) {
    std::vector<glm::vec2> triangles;
    if (!finite(clean)) return triangles;
    const Geos geos;
    // Rounding to float may have made a sliver cross itself: mend it once more.
    const Geos::Geometry polygon = madeValid(geos, polygonGeometry(geos, clean));
    if (!polygon) return triangles;
    const Geos::Geometry pieces = geos.own(GEOSConstrainedDelaunayTriangulation_r(geos, polygon.get()));
    if (!pieces) return triangles;
    const int count = GEOSGetNumGeometries_r(geos, pieces.get());
    triangles.reserve(3 * static_cast<std::size_t>(std::max(count, 0)));
    for (int i = 0; i < count; ++i) {
        const GEOSGeometry* ring = GEOSGetExteriorRing_r(geos, GEOSGetGeometryN_r(geos, pieces.get(), i));
        const GEOSCoordSequence* sequence = ring ? GEOSGeom_getCoordSeq_r(geos, ring) : nullptr;
        unsigned n = 0;
        if (!sequence || !GEOSCoordSeq_getSize_r(geos, sequence, &n) || n != 4) continue;
        glm::vec2 corner[3];
        for (unsigned k = 0; k < 3; ++k) {
            double x = 0;
            double y = 0;
            GEOSCoordSeq_getXY_r(geos, sequence, k, &x, &y);
            corner[k] = {static_cast<float>(x), static_cast<float>(y)};
        }
        const double twice = 2 * signedArea(corner);
        if (twice == 0) continue;
        if (twice < 0) std::swap(corner[1], corner[2]);
        triangles.insert(triangles.end(), corner, corner + 3);
    }
    return triangles;
}

std::vector<Footprint> intersection(const std::vector<Footprint>& a, const std::vector<Footprint>& b) {
    const Geos geos;
    const Geos::Geometry first = united(geos, a);
    const Geos::Geometry second = united(geos, b);
    std::vector<Footprint> out;
    if (first && second)
        collect(geos, geos.own(GEOSIntersection_r(geos, first.get(), second.get())).get(), out);
    return out;
}

std::vector<Footprint> difference(const std::vector<Footprint>& a, const std::vector<Footprint>& b) {
    const Geos geos;
    const Geos::Geometry first = united(geos, a);
    const Geos::Geometry second = united(geos, b);
    std::vector<Footprint> out;
    if (first && second)
        collect(geos, geos.own(GEOSDifference_r(geos, first.get(), second.get())).get(), out);
    return out;
}

std::vector<Footprint> unite(const std::vector<Footprint>& footprints) {
    const Geos geos;
    std::vector<Footprint> out;
    collect(geos, united(geos, footprints).get(), out);
    return out;
}

std::vector<Footprint> offset(const Footprint& footprint, double distance) {
    std::vector<Footprint> out;
    if (!std::isfinite(distance)) return out;
    const Geos geos;
    const Geos::Geometry polygon = united(geos, {footprint});
    constexpr int segmentsPerQuarter = 4;
    constexpr double mitreLimit = 2.5;
    if (polygon)
        collect(geos,
                geos.own(GEOSBufferWithStyle_r(geos, polygon.get(), distance, segmentsPerQuarter,
                                               GEOSBUF_CAP_FLAT, GEOSBUF_JOIN_MITRE, mitreLimit))
                    .get(),
                out);
    return out;
}

std::vector<Footprint> strip(std::span<const glm::vec2> line, double width) {
    std::vector<Footprint> out;
    if (!(width > 0)) return out;
    const Geos geos;
    const Geos::Geometry axis = lineGeometry(geos, line);
    if (!axis) return out;
    constexpr int segmentsPerQuarter = 4;
    constexpr double mitreLimit = 2;
    collect(geos,
            geos.own(GEOSBufferWithStyle_r(geos, axis.get(), width / 2, segmentsPerQuarter, GEOSBUF_CAP_FLAT,
                                           GEOSBUF_JOIN_MITRE, mitreLimit))
                .get(),
            out);
    return out;
}

std::vector<Footprint> splitBy(const Footprint& footprint, const std::vector<std::vector<glm::vec2>>& lines) {
    std::vector<Footprint> out;
    const Geos geos;
    const Geos::Geometry polygon = united(geos, {footprint});
    if (!polygon) return out;
    std::vector<GEOSGeometry*> pieces{GEOSBoundary_r(geos, polygon.get())};
    for (const auto& line : lines)
        if (Geos::Geometry geometry = lineGeometry(geos, line)) pieces.push_back(geometry.release());
    const Geos::Geometry all = geos.own(GEOSGeom_createCollection_r(
        geos, GEOS_GEOMETRYCOLLECTION, pieces.data(), static_cast<unsigned>(pieces.size())));
    // The union of lines is cut at every crossing, which is what polygonizing asks for.
    const Geos::Geometry noded = all ? geos.own(GEOSUnaryUnion_r(geos, all.get())) : geos.own(nullptr);
    if (!noded) return out;
    const GEOSGeometry* input[] = {noded.get()};
    std::vector<Footprint> faces;
    collect(geos, geos.own(GEOSPolygonize_r(geos, input, 1)).get(), faces);
    for (Footprint& face : faces) {
        for (Footprint& inside : intersection({face}, {footprint})) out.push_back(std::move(inside));
    }
    return out;
}

std::optional<OrientedRectangle> orientedRectangle(const Footprint& footprint) {
    if (!finite(footprint) || footprint.outer.size() < 3) return std::nullopt;
    const Geos geos;
    const Geos::Geometry ring = geos.own(ringGeometry(geos, footprint.outer));
    if (!ring) return std::nullopt;
    const Geos::Geometry hull = geos.own(GEOSConvexHull_r(geos, ring.get()));
    if (!hull || GEOSGeomTypeId_r(geos, hull.get()) != GEOS_POLYGON) return std::nullopt;
    const std::vector<glm::vec2> corners = ringOf(geos, GEOSGetExteriorRing_r(geos, hull.get()), true);
    if (corners.size() < 3) return std::nullopt;

    // The least rectangle has a side along an edge of the hull (Freeman and Shapira 1975). Hulls of buildings
    // are short, so every edge against every corner is quick enough.
    std::optional<OrientedRectangle> best;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const glm::dvec2 a = corners[i];
        const glm::dvec2 edge = glm::dvec2(corners[(i + 1) % corners.size()]) - a;
        const double length = std::hypot(edge.x, edge.y);
        if (!(length > 0)) continue;
        const glm::dvec2 u = edge / length;
        const glm::dvec2 v(-u.y, u.x);
        glm::dvec2 low(0);
        glm::dvec2 high(0);
        for (const glm::vec2 corner : corners) {
            const glm::dvec2 d = glm::dvec2(corner) - a;
            const glm::dvec2 q(d.x * u.x + d.y * u.y, d.x * v.x + d.y * v.y);
            low = {std::min(low.x, q.x), std::min(low.y, q.y)};
            high = {std::max(high.x, q.x), std::max(high.y, q.y)};
        }
        const glm::dvec2 half = 0.5 * (high - low);
        if (best && 4 * half.x * half.y >= double(best->area())) continue;
        const glm::dvec2 middle = 0.5 * (high + low);
        const bool along = half.x >= half.y;
        best = OrientedRectangle{glm::vec2(a + middle.x * u + middle.y * v), glm::vec2(along ? u : v),
                                 along ? glm::vec2(half) : glm::vec2(half.y, half.x)};
    }
    return best;
}

bool contains(const Footprint& footprint, glm::vec2 point) {
    bool inside = false;
    const auto cross = [&](const std::vector<glm::vec2>& ring) {
        for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
            const glm::dvec2 a = ring[i];
            const glm::dvec2 b = ring[j];
            if ((a.y > point.y) != (b.y > point.y) &&
                point.x < (b.x - a.x) * (point.y - a.y) / (b.y - a.y) + a.x)
                inside = !inside;
        }
    };
    cross(footprint.outer);
    for (const auto& hole : footprint.holes) cross(hole);
    return inside;
}

}  // namespace city
