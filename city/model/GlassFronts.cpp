#include "city/model/GlassFronts.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

namespace city {

namespace {

// The same rectangles as paintShopFront, paintGlassFacade and paintStoneFront draw; a test looks at their
// pictures.
constexpr std::array<PaneOfPattern, 4> shopPanes{{{{0.065f, 0.115f}, {0.335f, 0.765f}, clearGlass},
                                                  {{0.35f, 0.115f}, {0.605f, 0.765f}, clearGlass},
                                                  {{0.7f, 0.13f}, {0.9f, 0.6f}, clearGlass},
                                                  {{0.7f, 0.63f}, {0.9f, 0.76f}, clearGlass}}};
constexpr std::array<PaneOfPattern, 4> curtainPanes{{{{0.012f, 0.27f}, {0.488f, 0.985f}, sunGlass},
                                                     {{0.512f, 0.27f}, {0.988f, 0.985f}, sunGlass},
                                                     {{0.012f, 0.02f}, {0.488f, 0.25f}, sunGlass},
                                                     {{0.512f, 0.02f}, {0.988f, 0.25f}, sunGlass}}};
constexpr std::array<PaneOfPattern, 8> stonePanes{{{{0.065f, 0.43f}, {0.335f, 0.765f}, clearGlass},
                                                   {{0.35f, 0.43f}, {0.605f, 0.765f}, clearGlass},
                                                   {{0.7f, 0.63f}, {0.9f, 0.76f}, clearGlass},
                                                   {{0.065f, 0.175f}, {0.335f, 0.43f}, frostedGlass},
                                                   {{0.35f, 0.175f}, {0.605f, 0.43f}, frostedGlass},
                                                   {{0.7f, 0.13f}, {0.9f, 0.6f}, frostedGlass},
                                                   {{0, 0}, {0.67f, 0.155f}, polishedGranite},
                                                   {{0.93f, 0}, {1, 0.155f}, polishedGranite}}};

/// A normal's z beyond which a wall is no wall: 3 degrees.
constexpr double leastUpright = 0.05;
/// Fronts share a plane within so many metres: see reflection::coplanar, whose planes have this tolerance.
constexpr double samePlane = 1e-3;
/// Repeats of a pattern along one wall; more is no building.
constexpr int mostRepeats = 4096;

using Polygon = std::vector<glm::dvec2>;  // texture coordinates

/// The part of a convex polygon with axis * sign <= limit * sign.
Polygon cut(const Polygon& polygon, int axis, double limit, double sign) {
    Polygon kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const glm::dvec2 a = polygon[i], b = polygon[(i + 1) % polygon.size()];
        const double da = sign * (limit - a[axis]), db = sign * (limit - b[axis]);
        if (da >= 0) kept.push_back(a);
        if ((da > 0 && db < 0) || (da < 0 && db > 0)) kept.push_back(a + (b - a) * (da / (da - db)));
    }
    return kept;
}

double signedArea(const Polygon& p) {
    double twice = 0;
    for (std::size_t i = 0; i < p.size(); ++i) {
        const glm::dvec2 a = p[i], b = p[(i + 1) % p.size()];
        twice += a.x * b.y - a.y * b.x;
    }
    return twice / 2;
}

/// A convex piece of wall: one triangle, or two that make a quad.
struct Piece {
    std::array<const Vertex*, 4> corners{};
    std::size_t count = 0;
};

/// World as a linear function of texture coordinates over a piece.
struct Mapping {
    glm::dvec3 origin{0}, perU{0}, perV{0};
    glm::dvec3 at(const glm::dvec2& uv) const { return origin + uv.x * perU + uv.y * perV; }
};

bool mappingOf(const Piece& piece, Mapping& map) {
    const Vertex &a = *piece.corners[0], &b = *piece.corners[1], &c = *piece.corners[2];
    const glm::dvec2 ab(b.texcoord - a.texcoord), ac(c.texcoord - a.texcoord);
    const glm::dvec3 pb(b.position - a.position), pc(c.position - a.position);
    const double det = ab.x * ac.y - ab.y * ac.x;
    if (!(std::abs(det) > 1e-9)) return false;
    map.perU = (pb * ac.y - pc * ab.y) / det;
    map.perV = (pc * ab.x - pb * ac.x) / det;
    map.origin = glm::dvec3(a.position) - map.perU * double(a.texcoord.x) - map.perV * double(a.texcoord.y);
    const double area = glm::length(glm::cross(map.perU, map.perV));
    return std::isfinite(area) && area > 1e-6;
}

class Finder {
  public:
    explicit Finder(const CityModel& city) : city_(city) {}

    void look(const Mesh& mesh) {
        const auto& index = mesh.indices;
        for (std::size_t i = 0; i + 2 < index.size(); i += 3) {
            const Pattern pattern = patternOf(mesh.vertices[index[i]]);
            const bool quad =
                i + 5 < index.size() && index[i] == index[i + 3] && index[i + 2] == index[i + 4];
            if (panesOf(pattern).empty()) {
                const bool windows = pattern == Pattern::facadePlaster || pattern == Pattern::facadeBrick ||
                                     pattern == Pattern::facadeStone;
                if (windows) ++found_.census.painted;
                if (quad && windows) i += 3;
                continue;
            }
            Piece piece;
            piece.count = quad ? 4 : 3;
            for (std::size_t k = 0; k < 3; ++k) piece.corners[k] = &mesh.vertices[index[i + k]];
            if (quad) piece.corners[3] = &mesh.vertices[index[i + 5]];
            add(piece, pattern);
            if (quad) i += 3;
        }
    }

    GlassFronts finish() {
        std::vector<const GlassFront*> planes;
        for (const GlassFront& front : found_.fronts) {
            const auto same = [&](const GlassFront* other) {
                return glm::dot(front.normal, other->normal) > 0.999 &&
                       std::ranges::all_of(front.outline, [&](const glm::dvec3& p) {
                           return std::abs(glm::dot(other->normal, p - other->outline[0])) <= samePlane;
                       });
            };
            if (std::ranges::none_of(planes, same)) planes.push_back(&front);
        }
        found_.census.planes = planes.size();
        return std::move(found_);
    }

  private:
    Pattern patternOf(const Vertex& v) const {
        return v.material < city_.materials.size() ? city_.materials[v.material].pattern : Pattern::plain;
    }

    void add(const Piece& piece, Pattern pattern) {
        Mapping map;
        if (!mappingOf(piece, map)) return;
        const Vertex &a = *piece.corners[0], &b = *piece.corners[1], &c = *piece.corners[2];
        const glm::dvec3 across =
            glm::cross(glm::dvec3(b.position - a.position), glm::dvec3(c.position - a.position));
        const double length = glm::length(across);
        if (!(length > 0)) return;
        const glm::dvec3 normal = across / length;
        if (std::abs(normal.z) > leastUpright) {
            ++found_.census.notUpright;
            return;
        }
        Polygon wall;
        glm::dvec2 low(std::numeric_limits<double>::infinity()), high = -low;
        for (std::size_t k = 0; k < piece.count; ++k) {
            wall.emplace_back(piece.corners[k]->texcoord);
            low = glm::min(low, wall.back());
            high = glm::max(high, wall.back());
        }
        if (!(high.x - low.x < mostRepeats && high.y - low.y < mostRepeats)) return;
        std::vector<GlassSurface> surfaces;
        for (const PaneOfPattern& pane : panesOf(pattern))
            if (std::ranges::find(surfaces, pane.surface) == surfaces.end()) surfaces.push_back(pane.surface);
        for (const GlassSurface& surface : surfaces)
            addFront(map, wall, low, high, normal, pattern, a.material, surface);
    }

    /// The panes of one kind in a piece of wall.
    void addFront(const Mapping& map, const Polygon& wall, const glm::dvec2& low, const glm::dvec2& high,
                  const glm::dvec3& normal, Pattern pattern, std::uint32_t material,
                  const GlassSurface& surface) {
        GlassFront front;
        front.normal = normal;
        front.pattern = pattern;
        front.glass = surface;
        glm::dvec2 glassLow(std::numeric_limits<double>::infinity()), glassHigh = -glassLow;
        const double metresPerUv = glm::length(glm::cross(map.perU, map.perV));
        for (double row = std::floor(low.y); row < high.y; ++row) {
            for (double column = std::floor(low.x); column < high.x; ++column) {
                for (const PaneOfPattern& pane : panesOf(pattern)) {
                    if (pane.surface != surface) continue;
                    const glm::dvec2 from = glm::dvec2(column, row) + glm::dvec2(pane.low);
                    const glm::dvec2 to = glm::dvec2(column, row) + glm::dvec2(pane.high);
                    Polygon glass = cut(cut(wall, 0, from.x, -1), 0, to.x, 1);
                    glass = cut(cut(glass, 1, from.y, -1), 1, to.y, 1);
                    const double area = std::abs(signedArea(glass)) * metresPerUv;
                    // A sliver at a wall's end is frame.
                    if (glass.size() < 3 || area < 0.05) continue;
                    append(front, glass, map, normal, material);
                    front.area += area;
                    ++front.paneCount;
                    for (const glm::dvec2& p : glass) {
                        glassLow = glm::min(glassLow, p);
                        glassHigh = glm::max(glassHigh, p);
                    }
                }
            }
        }
        if (front.paneCount == 0 || front.area < leastGlass) {
            ++found_.census.tooSmall;
            return;
        }
        const glm::dvec3 out = normal * double(paneOffset);
        front.outline = {map.at(glassLow) + out, map.at({glassHigh.x, glassLow.y}) + out,
                         map.at(glassHigh) + out, map.at({glassLow.x, glassHigh.y}) + out};
        // Mirrored texture coordinates run the other way round.
        if (glm::dot(glm::cross(map.perU, map.perV), normal) < 0)
            std::swap(front.outline[1], front.outline[3]);
        front.bounds = front.panes.bounds();
        GlassCensus& census = found_.census;
        ++(surface == frostedGlass           ? census.frosted
           : surface == polishedGranite      ? census.stones
           : pattern == Pattern::facadeGlass ? census.curtainWalls
                                             : census.shopFronts);
        found_.census.panes += front.paneCount;
        found_.census.area += front.area;
        found_.fronts.push_back(std::move(front));
    }

    static void append(GlassFront& front, const Polygon& glass, const Mapping& map, const glm::dvec3& normal,
                       std::uint32_t material) {
        const auto base = static_cast<std::uint32_t>(front.panes.vertices.size());
        for (const glm::dvec2& p : glass)
            front.panes.vertices.push_back({glm::vec3(map.at(p) + normal * double(paneOffset)),
                                            glm::vec3(normal), glm::vec2(p), material});
        for (std::uint32_t k = 1; k + 1 < glass.size(); ++k)
            front.panes.indices.insert(front.panes.indices.end(), {base, base + k, base + k + 1});
    }

    const CityModel& city_;
    GlassFronts found_;
};

}  // namespace

std::span<const PaneOfPattern> panesOf(Pattern pattern) {
    if (pattern == Pattern::shopFront) return shopPanes;
    if (pattern == Pattern::facadeGlass) return curtainPanes;
    if (pattern == Pattern::stoneFront) return stonePanes;
    return {};
}

GlassFronts glassFronts(const CityModel& city) {
    Finder finder(city);
    for (const Chunk& chunk : city.chunks) finder.look(chunk.mesh);
    return finder.finish();
}

}  // namespace city
