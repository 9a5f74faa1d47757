#include "city/generate/OpenSpaces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "city/generate/PerimeterBlock.h"
#include "city/generate/Random.h"
#include "city/generate/Shapes.h"

namespace city {

namespace {

using Ring = std::vector<glm::vec2>;

constexpr float lift =
    0.012f;  // metres between ground layers: more than depth buffers confuse, less than one sees

glm::vec2 centreOf(const Ring& ring) {
    glm::vec2 sum(0);
    for (const glm::vec2& p : ring) sum += p;
    return sum / static_cast<float>(ring.size());
}

bool inside(const Ring& ring, glm::vec2 p, float margin) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
        if (glm::dot(p - ring[i], outward(ring[i], ring[(i + 1) % ring.size()])) > -margin) return false;
    }
    return true;
}

void addLayer(const Ring& ring, float z, std::uint32_t material, const Palette& palette,
              ChunkCollector& chunks) {
    if (ring.size() < 3) return;
    const glm::vec2 c = centreOf(ring);
    addDeck(chunks.at(ChunkKind::ground, c.x, c.y), ring, z, material, palette.repeat(material));
}

void addStrip(glm::vec2 a, glm::vec2 b, float width, float z, std::uint32_t material, const Palette& palette,
              ChunkCollector& chunks) {
    const glm::vec2 right = 0.5f * width * outward(a, b);
    addLayer({a + right, b + right, b - right, a - right}, z, material, palette, chunks);
}

}  // namespace

void addBlockGround(const Ring& ring, std::uint32_t material, const Palette& palette,
                    ChunkCollector& chunks) {
    constexpr float under = 0.4f;  // metres below the pavement's edge
    addLayer(insetRing(ring, -under), innerGround, material, palette, chunks);
}

void addSquare(const Ring& ring, const Palette& palette, const Standing& standing, Random& random,
               CityModel& model, ChunkCollector& chunks) {
    addBlockGround(ring, palette.cobbles, palette, chunks);
    const glm::vec2 c = centreOf(ring);
    const float z = innerGround;
    place(model, standing.fountain, {c + glm::vec2(0, -11), z}, {1, 0});
    place(model, standing.monument, {c + glm::vec2(0, 19), z}, {0, -1});
    // A walk of slabs from the avenue, by way of the fountain, to the monument.
    addStrip(c + glm::vec2(0, -34), c + glm::vec2(0, 30), 7, z + lift, palette.slabs, palette, chunks);
    for (const float x : {-1.0f, 1.0f}) {
        for (const float y : {-14.0f, 14.0f}) {
            // Lawns with stone rims.
            const glm::vec2 m = c + glm::vec2(20 * x, y + 2);
            const Ring lawn{m + glm::vec2(-9, -9), m + glm::vec2(9, -9), m + glm::vec2(9, 9),
                            m + glm::vec2(-9, 9)};
            if (!std::all_of(lawn.begin(), lawn.end(), [&](glm::vec2 p) { return inside(ring, p, 2); }))
                continue;
            addPrism(chunks.at(ChunkKind::ground, m.x, m.y), insetRing(lawn, -0.25f), z, z + 0.14f,
                     palette.granite, palette.granite, 2);
            addLayer(lawn, z + 0.14f + lift, palette.grass, palette, chunks);
            placeTree(model, standing.parkTrees, {m, z + 0.14f}, random);
            for (const float s : {-4.5f, 4.5f})
                place(model, standing.bench, {m.x - 10.6f * x, m.y + s, z}, {-x, 0});
            place(model, standing.squareLamp, {m.x - 10.4f * x, m.y, z}, {1, 0});
            place(model, standing.bin, {m.x - 10.5f * x, m.y + 7, z}, {1, 0});
        }
    }
    // Tree rows along the sides, open towards the avenue's middle.
    const Ring rows = insetRing(ring, 5.5f);
    for (std::size_t k = 0; k < rows.size(); ++k) {
        const glm::vec2 a = rows[k], b = rows[(k + 1) % rows.size()];
        const float length = glm::length(b - a);
        const int count = static_cast<int>(length / 8.5f);
        for (int i = 0; i < count; ++i) {
            const glm::vec2 p = a + (b - a) * ((static_cast<float>(i) + 0.5f) / static_cast<float>(count));
            if (k == 0 && std::abs(p.x - c.x) < 12) continue;
            placeTree(model, standing.avenueTrees, {p, z}, random);
        }
    }
    place(model, standing.kiosk, {c + glm::vec2(-14.5f, -31), z}, {0, -1});
    place(model, standing.advertColumns[0], {c + glm::vec2(14, -31), z}, {1, 0});
}

void addPark(const Ring& ring, const Palette& palette, const Standing& standing, Random& random,
             CityModel& model, ChunkCollector& chunks) {
    addBlockGround(ring, palette.grass, palette, chunks);
    const glm::vec2 c = centreOf(ring);
    const std::size_t n = ring.size();
    Ring gates;
    for (std::size_t k = 0; k < n; ++k) gates.push_back(0.5f * (ring[k] + ring[(k + 1) % n]));
    for (const glm::vec2& gate : gates)
        addStrip(gate, c + 3.0f * glm::normalize(gate - c), 3, innerGround + lift, palette.gravel, palette,
                 chunks);
    Ring round;
    for (int k = 0; k < 16; ++k) {
        const Turn turn(k / 16.0);
        round.push_back(c + 7.0f * glm::vec2(turn.cos, turn.sin));
    }
    addLayer(round, innerGround + 2 * lift, palette.gravel, palette, chunks);
    place(model, standing.squareLamp, {c, innerGround}, {1, 0});
    for (int k = 0; k < 6; ++k) {
        const Turn turn(k / 6.0 + 1.0 / 24);
        place(model, standing.bench, {c + 6.0f * glm::vec2(turn.cos, turn.sin), innerGround},
              {-turn.cos, -turn.sin});
    }
    // Hedges along the pavement, open at the gates.
    for (std::size_t k = 0; k < n; ++k) {
        const glm::vec2 a = ring[k], b = ring[(k + 1) % n], along = glm::normalize(b - a);
        const float middle = 0.5f * glm::length(b - a);
        Mesh& mesh = chunks.at(ChunkKind::furniture, gates[k].x, gates[k].y);
        addBox(mesh, a, along, {1.2f, middle - 2.5f, -1.3f, -0.4f, 0, 1.05f}, palette.foliageDark);
        addBox(mesh, a, along, {middle + 2.5f, 2 * middle - 1.2f, -1.3f, -0.4f, 0, 1.05f},
               palette.foliageDark);
    }
    // Trees where there is room: dart throwing.
    std::vector<glm::vec2> trees;
    for (int attempt = 0; attempt < 400 && trees.size() < 34; ++attempt) {
        const glm::vec2 p = c + glm::vec2(random.range(-60, 60), random.range(-60, 60));
        if (!inside(ring, p, 5) || glm::length(p - c) < 13) continue;
        bool free =
            std::all_of(trees.begin(), trees.end(), [&](glm::vec2 q) { return glm::length(p - q) > 7.5f; });
        for (const glm::vec2& gate : gates) {
            const glm::vec2 d = glm::normalize(gate - c);
            const glm::vec2 r = p - c;
            if (glm::dot(r, d) > 0 && std::abs(r.x * d.y - r.y * d.x) < 3) free = false;
        }
        if (!free) continue;
        trees.push_back(p);
        placeTree(model, standing.parkTrees, {p, innerGround}, random);
    }
}

void addCourtHouse(const Ring& ring, const Palette& palette, Random& random, ChunkCollector& chunks) {
    constexpr float shortest = 14, halfDepth = 5.5f, gap = 6;  // metres
    const glm::vec2 c = centreOf(ring);
    const glm::vec2 along = glm::normalize(ring[1] - ring[0]), out = outward(ring[0], ring[1]);
    const float half = 0.5f * glm::length(ring[1] - ring[0]) - 2 * gap;
    const glm::vec2 middle = c - random.range(-6, 6) * out;
    const Ring walls{middle - half * along + halfDepth * out, middle + half * along + halfDepth * out,
                     middle + half * along - halfDepth * out, middle - half * along - halfDepth * out};
    if (2 * half < shortest ||
        !std::all_of(walls.begin(), walls.end(), [&](glm::vec2 p) { return inside(ring, p, gap - 0.5f); }))
        return;
    BlockSide side;
    side.storeysLow = 2;
    side.storeysHigh = 4;
    HouseDesign design = drawHouse(side, 0, palette, random);
    design.cornice = false;
    if (design.roof == HouseRoof::mansard) design.roof = HouseRoof::gabled;
    Lot lot;
    for (const glm::vec2& p : walls) lot.corners.push_back({p, Side::court, 0});
    HouseMeshes meshes;
    appendHouse(lot, design, palette, 0, random, meshes);
    chunks.add(ChunkKind::building, meshes.solid);
}

void addCourt(const Ring& ring, const Palette& palette, const Standing& standing, Random& random,
              CityModel& model, ChunkCollector& chunks) {
    addLayer(ring, innerGround + lift, random.chance(0.6) ? palette.grass : palette.cobbles, palette, chunks);
    const glm::vec2 c = centreOf(ring);
    std::vector<glm::vec2> trees;
    const bool house = random.chance(0.65);
    if (house) addCourtHouse(ring, palette, random, chunks);
    for (int attempt = 0; attempt < 30 && trees.size() < 2; ++attempt) {
        const glm::vec2 p = c + glm::vec2(random.range(-30, 30), random.range(-30, 30));
        if (!inside(ring, p, 4.2f)) continue;
        if (house && std::abs(glm::dot(p - c, outward(ring[0], ring[1]))) < 17) continue;
        if (!std::all_of(trees.begin(), trees.end(), [&](glm::vec2 q) { return glm::length(p - q) > 8; }))
            continue;
        trees.push_back(p);
        placeTree(model, standing.parkTrees, {p, innerGround}, random);
    }
}

void addSurroundings(float half, const Palette& palette, Random& random, std::vector<Chunk>& chunks) {
    constexpr float base = -0.06f;  // metres: below everything that stands in the city
    const auto finish = [&](Mesh mesh) {
        const Aabb bounds = mesh.bounds();
        chunks.push_back({ChunkKind::ground, std::move(mesh), bounds});
    };
    const float near = half + 900;
    const std::array<glm::vec2, 4> in{{{-half, -half}, {half, -half}, {half, half}, {-half, half}}};
    Mesh floor;
    addDeck(floor, in, base, palette.streets.pavement, palette.repeat(palette.streets.pavement));
    finish(std::move(floor));

    constexpr int sectors = 48;
    constexpr std::array<float, 4> rises{0, 0.35f, 0.8f, 1};
    std::array<std::array<glm::vec3, sectors>, 4> hills;
    for (std::size_t r = 0; r < 4; ++r) {
        for (std::size_t k = 0; k < sectors; ++k) {
            const Turn turn(static_cast<double>(k) / sectors);
            const float radius = near + 550 * static_cast<float>(r);
            const float height = r == 0 ? base : rises[r] * random.range(70, 190);
            hills[r][k] = {radius * turn.cos, radius * turn.sin, height};
        }
    }
    for (std::size_t side = 0; side < 4; ++side) {
        Mesh mesh;
        // From the city's border out to the circle on which the hills begin: each sector's corner reaches to
        // the nearest border point.
        for (std::size_t k = side * sectors / 4; k < (side + 1) * sectors / 4; ++k) {
            const glm::vec3 a = hills[0][k], b = hills[0][(k + 1) % sectors];
            const auto onBorder = [&](const glm::vec3& p) {
                const float s = half / std::max(std::abs(p.x), std::abs(p.y));
                return glm::vec3(s * p.x, s * p.y, base);
            };
            const glm::vec3 c = onBorder(a), d = onBorder(b);
            const auto meadow = [&](const glm::vec3& p) {
                return Vertex{p, {0, 0, 1}, glm::vec2(p) / palette.repeat(palette.meadow), palette.meadow};
            };
            mesh.addQuad(meadow(c), meadow(a), meadow(b), meadow(d));
            for (std::size_t r = 0; r + 1 < 4; ++r) {
                addFacet(mesh, hills[r][k], hills[r + 1][k], hills[r + 1][(k + 1) % sectors], palette.hills,
                         50);
                addFacet(mesh, hills[r][k], hills[r + 1][(k + 1) % sectors], hills[r][(k + 1) % sectors],
                         palette.hills, 50);
            }
        }
        finish(std::move(mesh));
    }
}

}  // namespace city
