#include "city/roads/Region.h"

#include <geos_c.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace city {

namespace {

constexpr double gridSize = 1e-3;  // metres; a millimetre shows in no picture
constexpr int quadrantSegments = 6;

/// GEOS keeps its state in a handle; one a thread makes all calls reentrant.
GEOSContextHandle_t handle() {
    struct Context {
        GEOSContextHandle_t value = GEOS_init_r();
        Context() = default;
        Context(const Context&) = delete;
        Context& operator=(const Context&) = delete;
        ~Context() { GEOS_finish_r(value); }
    };
    thread_local Context context;
    return context.value;
}

GEOSCoordSequence* sequence(std::span<const glm::dvec3> points) {
    GEOSCoordSequence* s = GEOSCoordSeq_create_r(handle(), static_cast<unsigned>(points.size()), 2);
    for (unsigned i = 0; i < points.size(); ++i)
        GEOSCoordSeq_setXY_r(handle(), s, i, points[i].x, points[i].y);
    return s;
}

void forPolygons(const GEOSGeometry* g, const auto& visit) {
    if (g == nullptr) return;
    if (GEOSGeomTypeId_r(handle(), g) == GEOS_POLYGON) {
        if (GEOSisEmpty_r(handle(), g) == 0) visit(g);
        return;
    }
    const int n = GEOSGetNumGeometries_r(handle(), g);
    if (GEOSGeomTypeId_r(handle(), g) < GEOS_MULTIPOINT) return;
    for (int i = 0; i < n; ++i) forPolygons(GEOSGetGeometryN_r(handle(), g, i), visit);
}

std::vector<glm::dvec2> ringPoints(const GEOSGeometry* ring) {
    const GEOSCoordSequence* s = GEOSGeom_getCoordSeq_r(handle(), ring);
    unsigned n = 0;
    GEOSCoordSeq_getSize_r(handle(), s, &n);
    std::vector<glm::dvec2> points(n);
    for (unsigned i = 0; i < n; ++i) GEOSCoordSeq_getXY_r(handle(), s, i, &points[i].x, &points[i].y);
    return points;
}

double signedArea(const std::vector<glm::dvec2>& ring) {
    double sum = 0;
    for (std::size_t i = 1; i < ring.size(); ++i) {
        sum += ring[i - 1].x * ring[i].y - ring[i].x * ring[i - 1].y;
    }
    return 0.5 * sum;
}

}  // namespace

struct Region::Geometry {
    explicit Geometry(GEOSGeometry* g) : value(g) {}
    Geometry(const Geometry&) = delete;
    Geometry& operator=(const Geometry&) = delete;
    ~Geometry() { GEOSGeom_destroy_r(handle(), value); }
    GEOSGeometry* value;

    /// Takes ownership; a null (GEOS failed) or an empty result gives null.
    static std::shared_ptr<const Geometry> keep(GEOSGeometry* g) {
        if (g == nullptr) return nullptr;
        GEOSGeometry* snapped = GEOSGeom_setPrecision_r(handle(), g, gridSize, 0);
        if (snapped == nullptr) return std::make_shared<const Geometry>(g);
        GEOSGeom_destroy_r(handle(), g);
        return std::make_shared<const Geometry>(snapped);
    }
};

Region::Region() = default;
Region::Region(std::shared_ptr<const Geometry> geometry) : geometry_(std::move(geometry)) {}

Region Region::strip(const Polyline& line, double half) {
    if (line.size() < 2 || !(half > 0)) return {};
    GEOSGeometry* g = GEOSGeom_createLineString_r(handle(), sequence(line));
    if (g == nullptr) return {};
    GEOSGeometry* b =
        GEOSBufferWithStyle_r(handle(), g, half, quadrantSegments, GEOSBUF_CAP_FLAT, GEOSBUF_JOIN_ROUND, 2);
    GEOSGeom_destroy_r(handle(), g);
    return Region(Geometry::keep(b));
}

Region Region::disc(const glm::dvec3& centre, double radius) {
    GEOSGeometry* g = GEOSGeom_createPointFromXY_r(handle(), centre.x, centre.y);
    GEOSGeometry* b = GEOSBuffer_r(handle(), g, radius, 8);
    GEOSGeom_destroy_r(handle(), g);
    return Region(Geometry::keep(b));
}

Region Region::convexHull(std::span<const glm::dvec3> points) {
    if (points.size() < 3) return {};
    GEOSGeometry* g = GEOSGeom_createLineString_r(handle(), sequence(points));
    if (g == nullptr) return {};
    GEOSGeometry* hull = GEOSConvexHull_r(handle(), g);
    GEOSGeom_destroy_r(handle(), g);
    if (hull != nullptr && GEOSGeomTypeId_r(handle(), hull) != GEOS_POLYGON) {
        GEOSGeom_destroy_r(handle(), hull);
        return {};
    }
    return Region(Geometry::keep(hull));
}

Region Region::united(std::span<const Region> parts) {
    std::vector<GEOSGeometry*> list;
    for (const Region& part : parts) {
        if (!part.empty()) list.push_back(GEOSGeom_clone_r(handle(), part.geometry_->value));
    }
    if (list.empty()) return {};
    GEOSGeometry* all = GEOSGeom_createCollection_r(handle(), GEOS_GEOMETRYCOLLECTION, list.data(),
                                                    static_cast<unsigned>(list.size()));
    GEOSGeometry* one = GEOSUnaryUnionPrec_r(handle(), all, gridSize);
    GEOSGeom_destroy_r(handle(), all);
    return Region(Geometry::keep(one));
}

Region Region::with(const Region& other) const {
    const std::array<Region, 2> both{*this, other};
    return united(both);
}

Region Region::without(const Region& other) const {
    if (empty() || other.empty()) return *this;
    GEOSGeometry* g = GEOSDifferencePrec_r(handle(), geometry_->value, other.geometry_->value, gridSize);
    return g == nullptr ? *this : Region(Geometry::keep(g));
}

Region Region::within(const Region& other) const {
    if (empty() || other.empty()) return {};
    GEOSGeometry* g = GEOSIntersectionPrec_r(handle(), geometry_->value, other.geometry_->value, gridSize);
    return g == nullptr ? *this : Region(Geometry::keep(g));
}

Region Region::grown(double distance) const {
    if (empty()) return *this;
    GEOSGeometry* g = GEOSBuffer_r(handle(), geometry_->value, distance, quadrantSegments);
    return g == nullptr ? *this : Region(Geometry::keep(g));
}

Region Region::widened(double distance) const {
    if (empty()) return *this;
    GEOSGeometry* g = GEOSBufferWithStyle_r(handle(), geometry_->value, distance, 1, GEOSBUF_CAP_FLAT,
                                            GEOSBUF_JOIN_MITRE, 2);
    return g == nullptr ? *this : Region(Geometry::keep(g));
}

Region Region::simplified(double tolerance) const {
    if (empty()) return *this;
    GEOSGeometry* g = GEOSTopologyPreserveSimplify_r(handle(), geometry_->value, tolerance);
    return g == nullptr ? *this : Region(Geometry::keep(g));
}

Region Region::clipped(double minX, double minY, double maxX, double maxY) const {
    if (empty()) return *this;
    GEOSGeometry* g = GEOSClipByRect_r(handle(), geometry_->value, minX, minY, maxX, maxY);
    if (g == nullptr) return {};
    return Region(Geometry::keep(g));
}

bool Region::empty() const {
    return geometry_ == nullptr || GEOSisEmpty_r(handle(), geometry_->value) != 0;
}

double Region::area() const {
    double a = 0;
    if (!empty()) GEOSArea_r(handle(), geometry_->value, &a);
    return a;
}

std::array<double, 4> Region::bounds() const {
    std::array<double, 4> b{};
    if (empty()) return b;
    GEOSGeom_getXMin_r(handle(), geometry_->value, &b[0]);
    GEOSGeom_getYMin_r(handle(), geometry_->value, &b[1]);
    GEOSGeom_getXMax_r(handle(), geometry_->value, &b[2]);
    GEOSGeom_getYMax_r(handle(), geometry_->value, &b[3]);
    return b;
}

std::vector<glm::dvec2> Region::triangles() const {
    std::vector<glm::dvec2> out;
    if (empty()) return out;
    forPolygons(geometry_->value, [&](const GEOSGeometry* polygon) {
        GEOSGeometry* cut = GEOSConstrainedDelaunayTriangulation_r(handle(), polygon);
        forPolygons(cut, [&](const GEOSGeometry* triangle) {
            const auto ring = ringPoints(GEOSGetExteriorRing_r(handle(), triangle));
            if (ring.size() != 4) return;
            const double area = signedArea(ring);
            if (std::abs(area) < 1e-7) return;
            out.push_back(ring[0]);
            out.push_back(area > 0 ? ring[1] : ring[2]);
            out.push_back(area > 0 ? ring[2] : ring[1]);
        });
        if (cut != nullptr) GEOSGeom_destroy_r(handle(), cut);
    });
    return out;
}

std::vector<std::vector<glm::dvec2>> Region::borders() const {
    std::vector<std::vector<glm::dvec2>> out;
    if (empty()) return out;
    forPolygons(geometry_->value, [&](const GEOSGeometry* polygon) {
        auto outer = ringPoints(GEOSGetExteriorRing_r(handle(), polygon));
        if (signedArea(outer) < 0) std::reverse(outer.begin(), outer.end());
        out.push_back(std::move(outer));
        const int holes = GEOSGetNumInteriorRings_r(handle(), polygon);
        for (int i = 0; i < holes; ++i) {
            auto inner = ringPoints(GEOSGetInteriorRingN_r(handle(), polygon, i));
            if (signedArea(inner) > 0) std::reverse(inner.begin(), inner.end());
            out.push_back(std::move(inner));
        }
    });
    return out;
}

}  // namespace city
