#include "city/model/BuildingMesh.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <optional>

#include "city/model/PolygonAlgebra.h"
#include "city/model/RoofPlanes.h"

namespace city {

namespace {

/// Edges that turn by less than this form one curved wall whose bays are counted together.
constexpr double curvedWallCosine = 0.906307787;  // 25 degrees

/// Walls shorter than this hold no window, metres.
constexpr double leastWindowWall = 1.0;

/// Half the share of a bay that is blank pier on either side of every pattern's windows.
constexpr double pierHalf = 0.08;

/// A rest of wall lower than this above the ground floor joins the ground floor, metres.
constexpr double leastUpperWall = 0.5;

struct Heights {
    double base;
    double groundFloorTop;  ///< equal to base: no ground floor
    double eaves;
    double storeys;  ///< v at the eaves
};

struct WallEdge {
    glm::dvec2 a;
    glm::dvec2 b;
    double uA;
    double uB;
};

/// The ring's edges with bays counted along each wall.
std::vector<WallEdge> wallEdges(const std::vector<glm::vec2>& ring, double bayWidth) {
    const std::size_t n = ring.size();
    std::vector<double> length(n);
    std::vector<glm::dvec2> direction(n);
    for (std::size_t i = 0; i < n; ++i) {
        const glm::dvec2 d = glm::dvec2(ring[(i + 1) % n]) - glm::dvec2(ring[i]);
        length[i] = std::hypot(d.x, d.y);
        direction[i] = d / length[i];
    }
    // A sharp corner to start from; a round tower has none and starts anywhere.
    const auto sharp = [&](std::size_t corner) {
        return glm::dot(direction[(corner + n - 1) % n], direction[corner % n]) < curvedWallCosine;
    };
    std::size_t start = 0;
    while (start < n && !sharp(start)) ++start;
    if (start == n) start = 0;

    std::vector<WallEdge> edges;
    for (std::size_t done = 0; done < n;) {
        std::size_t count = 1;
        while (done + count < n && !sharp(start + done + count)) ++count;
        double whole = 0;
        for (std::size_t k = 0; k < count; ++k) whole += length[(start + done + k) % n];
        double u = 0;
        double perMetre = 0;
        if (whole > leastWindowWall) {
            perMetre = std::max(1.0, std::round(whole / bayWidth)) / whole;
        } else {
            const double span = std::min(whole / bayWidth, 2 * pierHalf);
            perMetre = span / whole;
            u = -span / 2;
        }
        for (std::size_t k = 0; k < count; ++k) {
            const std::size_t i = (start + done + k) % n;
            const double next = u + length[i] * perMetre;
            edges.push_back({ring[i], ring[(i + 1) % n], u, next});
            u = next;
        }
        done += count;
    }
    return edges;
}

Vertex corner(glm::dvec2 p, double z, glm::vec3 normal, double u, double v, std::uint32_t material) {
    return {glm::vec3(float(p.x), float(p.y), float(z)), normal, glm::vec2(float(u), float(v)), material};
}

void appendWall(const WallEdge& e, const Heights& h, const BuildingShape& shape,
                const std::vector<RoofPlane>& planes, Mesh& mesh) {
    const glm::dvec2 d = glm::normalize(e.b - e.a);
    const glm::vec3 normal(float(d.y), float(-d.x), 0);
    const auto band = [&](double z0, double z1, double v1, std::uint32_t material) {
        mesh.addQuad(corner(e.a, z0, normal, e.uA, 0, material), corner(e.b, z0, normal, e.uB, 0, material),
                     corner(e.b, z1, normal, e.uB, v1, material),
                     corner(e.a, z1, normal, e.uA, v1, material));
    };
    if (h.groundFloorTop > h.base) band(h.base, h.groundFloorTop, 1, shape.groundFloorMaterial);
    if (h.eaves > h.groundFloorTop) band(h.groundFloorTop, h.eaves, h.storeys, shape.wallMaterial);
    if (planes.empty()) return;

    // Gables: from the eaves up to the roof, blank.
    std::vector<double> stops = roofBreaks(planes, e.a, e.b);
    stops.insert(stops.begin(), 0.0);
    stops.push_back(1.0);
    const auto v = [&](double z) { return h.storeys + (z - h.eaves) / shape.storeyHeight; };
    const auto u = [](double t) { return pierHalf * (2 * t - 1); };
    for (std::size_t i = 0; i + 1 < stops.size(); ++i) {
        const glm::dvec2 a = e.a + stops[i] * (e.b - e.a);
        const glm::dvec2 b = e.a + stops[i + 1] * (e.b - e.a);
        const double zA = std::max(roofHeight(planes, a), h.eaves);
        const double zB = std::max(roofHeight(planes, b), h.eaves);
        const Vertex footA = corner(a, h.eaves, normal, u(stops[i]), h.storeys, shape.wallMaterial);
        const Vertex footB = corner(b, h.eaves, normal, u(stops[i + 1]), h.storeys, shape.wallMaterial);
        const Vertex topA = corner(a, zA, normal, u(stops[i]), v(zA), shape.wallMaterial);
        const Vertex topB = corner(b, zB, normal, u(stops[i + 1]), v(zB), shape.wallMaterial);
        const bool riseA = zA > h.eaves + cornerTolerance;
        const bool riseB = zB > h.eaves + cornerTolerance;
        if (riseA && riseB)
            mesh.addQuad(footA, footB, topB, topA);
        else if (riseA)
            mesh.addTriangle(footA, footB, topA);
        else if (riseB)
            mesh.addTriangle(footA, footB, topB);
    }
}

void appendFlatRoof(const Footprint& part, const BuildingShape& shape, Mesh& mesh) {
    const std::vector<glm::vec2> triangles = triangulateClean(part);
    const double repeat = shape.roofPatternSize;
    const auto vertex = [&](glm::vec2 p) {
        return corner(p, shape.eaves, {0, 0, 1}, p.x / repeat, p.y / repeat, shape.roofMaterial);
    };
    for (std::size_t i = 0; i + 2 < triangles.size(); i += 3)
        mesh.addTriangle(vertex(triangles[i]), vertex(triangles[i + 1]), vertex(triangles[i + 2]));
}

void appendPitchedRoof(const Footprint& part, const BuildingShape& shape,
                       const std::vector<RoofPlane>& planes, Mesh& mesh) {
    const OrientedRectangle rectangle = *orientedRectangle(part);
    const double reach = 2 * double(rectangle.half.x) + 1;
    for (std::size_t i = 0; i < planes.size(); ++i) {
        Footprint region;
        region.outer = roofRegion(planes, i, rectangle.centre, reach);
        if (region.outer.size() < 3) continue;
        const RoofPlane& plane = planes[i];
        const glm::dvec2 slope = plane.slope;
        const double steepness = std::hypot(slope.x, slope.y);
        const glm::dvec2 up = slope / steepness;
        const double perMetre = std::sqrt(1 + steepness * steepness);
        const auto normal = glm::vec3(glm::normalize(glm::dvec3(-slope.x, -slope.y, 1)));
        const auto vertex = [&](glm::vec2 corner2) {
            const glm::dvec2 p = corner2;
            const glm::dvec2 q = p - plane.foot;
            return corner(p, plane.height(p), normal, (up.y * q.x - up.x * q.y) / shape.roofPatternSize,
                          (up.x * q.x + up.y * q.y) * perMetre / shape.roofPatternSize, shape.roofMaterial);
        };
        for (const Footprint& piece : intersection({part}, {region})) {
            const std::vector<glm::vec2> triangles = triangulateClean(piece);
            for (std::size_t k = 0; k + 2 < triangles.size(); k += 3)
                mesh.addTriangle(vertex(triangles[k]), vertex(triangles[k + 1]), vertex(triangles[k + 2]));
        }
    }
}

/// Half an ellipsoid over the footprint: rings that shrink towards the centre as the cosine, rise as the
/// sine.
void appendDome(const Footprint& part, glm::dvec2 centre, const BuildingShape& shape, Mesh& mesh) {
    constexpr int rings = 6;
    const auto n = part.outer.size();
    const auto point = [&](std::size_t i, int ring) {
        const double angle = 0.5 * std::numbers::pi * ring / rings;
        const double shrink = ring == rings ? 0 : std::cos(angle);
        return glm::dvec3(centre + shrink * (glm::dvec2(part.outer[i % n]) - centre),
                          shape.eaves + std::sin(angle) * (double(shape.ridge) - shape.eaves));
    };
    for (std::size_t i = 0; i < n; ++i) {
        const double length = glm::distance(glm::dvec2(part.outer[i]), glm::dvec2(part.outer[(i + 1) % n]));
        for (int ring = 0; ring < rings; ++ring) {
            const glm::dvec3 a = point(i, ring);
            const glm::dvec3 b = point(i + 1, ring);
            const glm::dvec3 c = point(i + 1, ring + 1);
            const glm::dvec3 d = point(i, ring + 1);
            const auto normal = glm::vec3(glm::normalize(glm::cross(b - a, d - a)));
            const auto vertex = [&](const glm::dvec3& p, double u, double v) {
                return corner(glm::dvec2(p), p.z, normal, u / shape.roofPatternSize,
                              v / shape.roofPatternSize, shape.roofMaterial);
            };
            const double v0 = ring * length;
            if (ring + 1 == rings)
                mesh.addTriangle(vertex(a, 0, v0), vertex(b, length, v0), vertex(c, length / 2, v0 + length));
            else
                mesh.addQuad(vertex(a, 0, v0), vertex(b, length, v0), vertex(c, length, v0 + length),
                             vertex(d, 0, v0 + length));
        }
    }
}

bool usable(const BuildingShape& shape) {
    for (const float value : {shape.base, shape.eaves, shape.ridge, shape.storeyHeight, shape.bayWidth,
                              shape.groundFloorHeight, shape.roofPatternSize})
        if (!std::isfinite(value)) return false;
    return shape.eaves - shape.base > cornerTolerance && shape.storeyHeight > 0 && shape.bayWidth > 0 &&
           shape.roofPatternSize > 0;
}

Heights heightsOf(const BuildingShape& shape) {
    Heights h{shape.base, shape.base, shape.eaves, 0};
    if (shape.groundFloorHeight > 0)
        h.groundFloorTop = std::min(double(shape.base) + shape.groundFloorHeight, double(shape.eaves));
    if (h.groundFloorTop > h.base && h.eaves - h.groundFloorTop < leastUpperWall) h.groundFloorTop = h.eaves;
    const double storeys = (h.eaves - h.groundFloorTop) / shape.storeyHeight;
    // A plinth or a kiosk lower than half a storey shows the foot of the pattern, not a squeezed window.
    h.storeys = storeys < 0.5 ? storeys : std::round(storeys);
    return h;
}

}  // namespace

BuildStatus appendBuilding(const BuildingShape& shape, Mesh& mesh) {
    if (!usable(shape)) return BuildStatus::degenerate;
    const CleanFootprints clean = cleanFootprint(shape.footprint);
    if (clean.parts.empty()) return BuildStatus::degenerate;
    const Heights heights = heightsOf(shape);
    for (const Footprint& part : clean.parts) {
        const std::vector<RoofPlane> planes = roofPlanes(part, shape.roof, shape.eaves, shape.ridge);
        for (const WallEdge& edge : wallEdges(part.outer, shape.bayWidth))
            appendWall(edge, heights, shape, planes, mesh);
        for (const auto& hole : part.holes)
            for (const WallEdge& edge : wallEdges(hole, shape.bayWidth))
                appendWall(edge, heights, shape, {}, mesh);
        const bool domed = shape.roof == RoofShape::dome && shape.ridge - shape.eaves > cornerTolerance;
        const std::optional<glm::dvec2> dome = domed ? domeCentre(part) : std::nullopt;
        if (dome)
            appendDome(part, *dome, shape, mesh);
        else if (planes.empty())
            appendFlatRoof(part, shape, mesh);
        else
            appendPitchedRoof(part, shape, planes, mesh);
    }
    return clean.repaired ? BuildStatus::repaired : BuildStatus::built;
}

std::vector<glm::vec2> triangulate(const Footprint& footprint) {
    std::vector<glm::vec2> triangles;
    for (const Footprint& part : cleanFootprint(footprint).parts) {
        const std::vector<glm::vec2> piece = triangulateClean(part);
        triangles.insert(triangles.end(), piece.begin(), piece.end());
    }
    return triangles;
}

}  // namespace city
