#include "city/import/OsmGround.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "city/import/OsmBuildings.h"
#include "city/import/OsmStreets.h"
#include "city/import/OsmValues.h"
#include "city/model/PolygonAlgebra.h"

namespace city {

namespace {

constexpr std::size_t coverCount = static_cast<std::size_t>(Cover::count);

/// Water's surface under the ground around it: a quay's edge, metres.
constexpr float waterDepth = 0.6f;

/// Beyond the bounds the ground goes on for this far, so that streets do not end in the sky, metres.
constexpr float apron = 1500;
constexpr float apronHeight = -0.8f;

/// Coastlines that end this near to the bounds were cut off there by the file, metres.
constexpr float coastReach = 150;

Footprint rectangle(glm::vec2 low, glm::vec2 high) {
    return {{low, {high.x, low.y}, high, {low.x, high.y}}, {}};
}

std::optional<Cover> coverOf(const OsmTags& tags) {
    const std::string_view natural = tags.get("natural");
    const std::string_view landuse = tags.get("landuse");
    const std::string_view leisure = tags.get("leisure");
    if (natural == "water" || tags.has("water") || tags.is("waterway", "riverbank") || landuse == "basin" ||
        landuse == "reservoir" || landuse == "pond" || tags.is("amenity", "fountain") ||
        leisure == "swimming_pool")
        return Cover::water;
    if (leisure == "pitch" || leisure == "track" || leisure == "playground") return Cover::sport;
    if (tags.is("amenity", "parking") && !tags.is("parking", "underground") &&
        !tags.is("parking", "multi-storey"))
        return Cover::asphalt;
    const std::string_view highway = tags.get("highway");
    if (highway == "pedestrian" || highway == "footway" || tags.is("place", "square")) return Cover::square;
    if (highway == "service" || highway == "residential") return Cover::asphalt;
    if (tags.is("man_made", "pier") || tags.is("man_made", "bridge")) return Cover::square;
    if (landuse == "grass" || landuse == "village_green" || landuse == "flowerbed" || leisure == "garden" ||
        leisure == "park" || natural == "grassland" || landuse == "recreation_ground" ||
        landuse == "cemetery" || leisure == "dog_park")
        return Cover::grass;
    if (natural == "scrub" || natural == "heath" || landuse == "meadow" || natural == "wetland" ||
        landuse == "farmland" || landuse == "allotments")
        return Cover::meadow;
    if (natural == "wood" || landuse == "forest") return Cover::wood;
    if (natural == "bare_rock" || natural == "rock" || natural == "sand" || natural == "beach" ||
        landuse == "construction" || landuse == "brownfield" || landuse == "quarry" || natural == "shingle")
        return Cover::soil;
    return std::nullopt;
}

double pathWidth(const OsmTags& tags, WayUse use) {
    if (const auto width = parseLength(tags.get("width")); width && *width > 0.5 && *width < 30)
        return *width;
    if (use == WayUse::rail) return 3;
    if (use == WayUse::service) return tags.is("service", "driveway") ? 3 : 4;
    if (tags.is("highway", "pedestrian")) return 6;
    if (tags.is("highway", "platform")) return 3;
    return 2.5;
}

/// An open coastline's end is moved to the nearest point of the bounds if they are near.
void reachBounds(glm::vec2 inner, glm::vec2& end, glm::vec2 half) {
    if (std::abs(end.x) >= half.x || std::abs(end.y) >= half.y) return;
    const float toX = half.x - std::abs(end.x);
    const float toY = half.y - std::abs(end.y);
    if (std::min(toX, toY) > coastReach) return;
    glm::vec2 target = end;
    // A little beyond: the lines must cross.
    if (toX < toY)
        target.x = std::copysign(half.x + 1, end.x);
    else
        target.y = std::copysign(half.y + 1, end.y);
    if (target != inner) end = target;
}

void planSea(const OsmData& data, GroundPlan& plan) {
    // Ways join into long lines first: their inner ends are no ends.
    std::vector<std::vector<std::int64_t>> nodes;
    std::vector<std::vector<glm::vec2>> lines;
    for (const OsmLine& way : data.lines) {
        if (!way.tags.is("natural", "coastline")) continue;
        std::size_t start = 0;
        for (std::size_t i = 1; i <= way.nodes.size(); ++i) {
            if (i < way.nodes.size() && !way.gaps.contains(i)) continue;
            if (i - start > 1) {
                const auto from = static_cast<std::ptrdiff_t>(start);
                const auto to = static_cast<std::ptrdiff_t>(i);
                nodes.emplace_back(way.nodes.begin() + from, way.nodes.begin() + to);
                lines.emplace_back(way.points.begin() + from, way.points.begin() + to);
            }
            start = i;
        }
    }
    for (bool joined = true; joined;) {
        joined = false;
        for (std::size_t a = 0; a < lines.size() && !joined; ++a) {
            for (std::size_t b = 0; b < lines.size() && !joined; ++b) {
                if (a == b || nodes[a].back() != nodes[b].front()) continue;
                nodes[a].insert(nodes[a].end(), nodes[b].begin() + 1, nodes[b].end());
                lines[a].insert(lines[a].end(), lines[b].begin() + 1, lines[b].end());
                nodes.erase(nodes.begin() + static_cast<std::ptrdiff_t>(b));
                lines.erase(lines.begin() + static_cast<std::ptrdiff_t>(b));
                joined = true;
            }
        }
    }
    if (lines.empty()) return;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        if (nodes[i].front() == nodes[i].back()) continue;
        auto& line = lines[i];
        reachBounds(line[1], line.front(), data.halfSize);
        reachBounds(line[line.size() - 2], line.back(), data.halfSize);
    }
    const std::vector<Footprint> faces = splitBy(rectangle(-data.halfSize, data.halfSize), lines);
    // Water lies to the right of coastlines: a face is sea when it holds a point just right of one.
    std::vector<bool> isSea(faces.size(), false);
    for (const auto& line : lines) {
        bool parts = false;
        for (std::size_t i = 0; i + 1 < line.size(); ++i) {
            const glm::vec2 d = line[i + 1] - line[i];
            const float length = glm::length(d);
            if (!(length > 0.5f)) continue;
            const glm::vec2 middle = 0.5f * (line[i] + line[i + 1]);
            const glm::vec2 right = glm::vec2(d.y, -d.x) * (0.05f / length);
            for (std::size_t f = 0; f < faces.size(); ++f) {
                const bool onRight = contains(faces[f], middle + right);
                if (!onRight || contains(faces[f], middle - right)) continue;
                isSea[f] = true;
                parts = true;
            }
        }
        const bool within = std::any_of(line.begin(), line.end(), [&](glm::vec2 p) {
            return std::abs(p.x) < data.halfSize.x && std::abs(p.y) < data.halfSize.y;
        });
        if (!parts && within) ++plan.openCoastlines;
    }
    for (std::size_t f = 0; f < faces.size(); ++f) {
        if (!isSea[f]) continue;
        plan.covers[static_cast<std::size_t>(Cover::water)].push_back(faces[f]);
        plan.sea = true;
    }
}

struct CoverLook {
    std::uint32_t material;
    float height;
};

void addFlat(const std::vector<Footprint>& footprints, const CoverLook& look, const Palette& palette,
             Mesh& mesh) {
    const float repeat = palette.repeat(look.material);
    for (const Footprint& footprint : footprints) {
        const std::vector<glm::vec2> corners = triangulateClean(footprint);
        for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
            const auto vertex = [&](glm::vec2 p) {
                return Vertex{glm::vec3(p, look.height), {0, 0, 1}, p / repeat, look.material};
            };
            mesh.addTriangle(vertex(corners[i]), vertex(corners[i + 1]), vertex(corners[i + 2]));
        }
    }
}

/// Walls down to the water around it, seen from the water.
void addQuays(const std::vector<Footprint>& water, glm::vec2 low, glm::vec2 high, std::uint32_t material,
              Mesh& mesh) {
    const auto onCellBorder = [&](glm::vec2 a, glm::vec2 b) {
        const float near = 2 * cornerTolerance;
        return (std::abs(a.x - low.x) < near && std::abs(b.x - low.x) < near) ||
               (std::abs(a.x - high.x) < near && std::abs(b.x - high.x) < near) ||
               (std::abs(a.y - low.y) < near && std::abs(b.y - low.y) < near) ||
               (std::abs(a.y - high.y) < near && std::abs(b.y - high.y) < near);
    };
    const auto ring = [&](const std::vector<glm::vec2>& corners) {
        for (std::size_t i = 0; i < corners.size(); ++i) {
            const glm::vec2 a = corners[(i + 1) % corners.size()];  // backwards: the wall looks inwards
            const glm::vec2 b = corners[i];
            if (onCellBorder(a, b)) continue;
            const float length = glm::distance(a, b);
            const glm::vec3 normal((b.y - a.y) / length, -(b.x - a.x) / length, 0);
            const float foot = groundHeight - waterDepth;
            mesh.addQuad({glm::vec3(a, foot), normal, {0, 0}, material},
                         {glm::vec3(b, foot), normal, {length, 0}, material},
                         {glm::vec3(b, groundHeight), normal, {length, waterDepth}, material},
                         {glm::vec3(a, groundHeight), normal, {0, waterDepth}, material});
        }
    };
    for (const Footprint& footprint : water) {
        ring(footprint.outer);
        for (const auto& hole : footprint.holes) ring(hole);
    }
}

/// The two rails of a track, as ribbons on its bed.
void addRails(const std::vector<glm::vec2>& track, std::uint32_t material, Mesh& mesh) {
    constexpr float halfGauge = 0.75f;
    constexpr float width = 0.12f;
    constexpr float height = groundHeight + 0.03f;
    for (std::size_t i = 0; i + 1 < track.size(); ++i) {
        const glm::vec2 d = track[i + 1] - track[i];
        const float length = glm::length(d);
        if (!(length > 0)) continue;
        const glm::vec2 left = glm::vec2(-d.y, d.x) / length;
        for (const float side : {-halfGauge, halfGauge}) {
            const auto corner = [&](glm::vec2 p, float across, float along) {
                return Vertex{
                    glm::vec3(p + (side + across) * left, height), {0, 0, 1}, {across, along}, material};
            };
            mesh.addQuad(corner(track[i], -width / 2, 0), corner(track[i + 1], -width / 2, length),
                         corner(track[i + 1], width / 2, length), corner(track[i], width / 2, 0));
        }
    }
}

struct Boxed {
    const Footprint* footprint;
    glm::vec2 low;
    glm::vec2 high;
};

}  // namespace

GroundPlan planGround(const OsmData& data) {
    GroundPlan plan;
    plan.covers.resize(coverCount);
    const auto put = [&](Cover cover, std::vector<Footprint> footprints) {
        auto& list = plan.covers[static_cast<std::size_t>(cover)];
        std::move(footprints.begin(), footprints.end(), std::back_inserter(list));
    };
    for (const OsmArea& area : data.areas) {
        if (area.tags.has("building") || area.tags.has("building:part") || isUnderground(area.tags)) continue;
        const std::optional<Cover> cover = coverOf(area.tags);
        if (!cover) continue;
        plan.waterAreas += cover == Cover::water;
        plan.greenAreas += cover == Cover::grass || cover == Cover::meadow || cover == Cover::wood;
        for (const Footprint& polygon : area.polygons) put(*cover, cleanFootprint(polygon).parts);
    }
    for (const OsmLine& way : data.lines) {
        const WayUse use = wayUse(way.tags);
        if ((use != WayUse::service && use != WayUse::path && use != WayUse::rail) ||
            isUnderground(way.tags) || way.tags.is("highway", "corridor") || way.tags.is("indoor", "yes"))
            continue;
        const Cover cover = use == WayUse::rail      ? Cover::rails
                            : use == WayUse::service ? Cover::asphalt
                                                     : Cover::path;
        for (const OsmPiece& piece : piecesWithin(way, data.halfSize)) {
            put(cover, strip(piece.points, pathWidth(way.tags, use)));
            ++plan.paths;
            if (use == WayUse::rail) plan.tracks.push_back(piece.points);
        }
    }
    planSea(data, plan);
    return plan;
}

std::vector<Mesh> buildGround(const GroundPlan& plan, glm::vec2 halfSize, const Palette& palette,
                              float cell) {
    std::array<CoverLook, coverCount> looks;
    const auto look = [&](Cover cover, std::uint32_t material) {
        looks[static_cast<std::size_t>(cover)] = {
            material, cover == Cover::water ? groundHeight - waterDepth : groundHeight};
    };
    look(Cover::rails, palette.gravel);
    look(Cover::asphalt, palette.streets.asphalt);
    look(Cover::path, palette.slabs);
    look(Cover::water, palette.water);
    look(Cover::sport, palette.gravel);
    look(Cover::square, palette.cobbles);
    look(Cover::grass, palette.grass);
    look(Cover::meadow, palette.meadow);
    look(Cover::wood, palette.soil);
    look(Cover::soil, palette.soil);
    const CoverLook base{palette.streets.pavement, groundHeight};

    std::array<std::vector<Boxed>, coverCount> boxed;
    for (std::size_t c = 0; c < coverCount; ++c) {
        for (const Footprint& footprint : plan.covers[c]) {
            Boxed box{&footprint, glm::vec2(1e30f), glm::vec2(-1e30f)};
            for (const glm::vec2 p : footprint.outer) {
                box.low = glm::min(box.low, p);
                box.high = glm::max(box.high, p);
            }
            boxed[c].push_back(box);
        }
    }

    const glm::ivec2 cells(glm::ceil(2.0f * halfSize / cell));
    const glm::vec2 size = 2.0f * halfSize / glm::vec2(cells);
    std::vector<Mesh> meshes(static_cast<std::size_t>(cells.x) * static_cast<std::size_t>(cells.y) + 1);
    tbb::parallel_for(0, cells.x * cells.y, [&](int index) {
        const glm::ivec2 at(index % cells.x, index / cells.x);
        const glm::vec2 low = -halfSize + glm::vec2(at) * size;
        const glm::vec2 high = -halfSize + glm::vec2(at + 1) * size;
        Mesh& mesh = meshes[static_cast<std::size_t>(index)];
        std::vector<Footprint> free{rectangle(low, high)};
        for (std::size_t c = 0; c < coverCount && !free.empty(); ++c) {
            std::vector<Footprint> claims;
            for (const Boxed& box : boxed[c])
                if (box.low.x < high.x && box.low.y < high.y && box.high.x > low.x && box.high.y > low.y)
                    claims.push_back(*box.footprint);
            if (claims.empty()) continue;
            const std::vector<Footprint> taken = intersection(free, claims);
            if (taken.empty()) continue;
            free = difference(free, claims);
            addFlat(taken, looks[c], palette, mesh);
            if (c == static_cast<std::size_t>(Cover::water))
                addQuays(taken, low, high, palette.granite, mesh);
        }
        addFlat(free, base, palette, mesh);
    });
    // Around and below everything, also under the hairlines between cells.
    const glm::vec2 reach = halfSize + apron;
    addFlat({rectangle(-reach, reach)}, {palette.hills, apronHeight}, palette, meshes.back());
    Mesh rails;
    for (const auto& track : plan.tracks) addRails(track, palette.streets.rail, rails);
    meshes.push_back(std::move(rails));
    std::erase_if(meshes, [](const Mesh& mesh) { return mesh.empty(); });
    return meshes;
}

}  // namespace city
