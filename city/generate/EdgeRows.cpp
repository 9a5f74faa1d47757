#include "city/generate/EdgeRows.h"

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>

#include "city/generate/HouseParts.h"
#include "city/generate/OpenSpaces.h"
#include "city/generate/Random.h"
#include "city/generate/Shapes.h"

namespace city {

namespace {

constexpr float houseDepth = 13;     // metres
constexpr float landmarkHalf = 24;   // metres of front to each side of the avenue's axis
constexpr float landmarkDepth = 20;  // metres

/// Lot of four corners: front from s0 to s1 along, `depth` deep behind it, `forward` metres in front of the
/// row's line.
Lot rowLot(glm::vec2 start, glm::vec2 along, float s0, float s1, float depth, float forward = 0) {
    const glm::vec2 out(along.y, -along.x);
    const glm::vec2 a = start + s0 * along + forward * out, b = start + s1 * along + forward * out;
    Lot lot;
    lot.corners = {{a, Side::street, 0},
                   {b, Side::party, 0},
                   {b - depth * out, Side::court, 0},
                   {a - depth * out, Side::party, 0}};
    return lot;
}

void addPediment(const Lot& lot, float z, float halfWidth, float rise, std::uint32_t material, Mesh& mesh) {
    const glm::vec2 a = lot.corners[0].position, b = lot.corners[1].position;
    const glm::vec2 along = glm::normalize(b - a), out(along.y, -along.x), middle = 0.5f * (a + b);
    const auto at = [&](float s, float t, float up) {
        return glm::vec3(middle + s * along + t * out, z + up);
    };
    constexpr float front = 1.5f, back = -6;
    addFacet(mesh, at(-halfWidth, front, 0), at(halfWidth, front, 0), at(0, front, rise), material);
    addPanel(mesh, at(halfWidth, front, 0), at(halfWidth, back, 0), at(0, back, rise), at(0, front, rise),
             material, 4, 3);
    addPanel(mesh, at(-halfWidth, back, 0), at(-halfWidth, front, 0), at(0, front, rise), at(0, back, rise),
             material, 4, 3);
}

/// Stone front with a portico and a clock tower.
void addTownHall(const Lot& lot, const Palette& palette, Random& random, HouseMeshes& meshes) {
    HouseDesign design;
    design.style = palette.facades[palette.firstGlassFacade - 3];
    design.storeys = 4;
    design.storeyHeight = 4.3f;
    design.groundFloorHeight = 5.2f;
    design.bayWidth = 3.4f;
    design.roof = HouseRoof::mansard;
    design.roofMaterial = palette.copper;
    design.roofHeight = 6.5f;
    design.dormers = true;
    appendHouse(lot, design, palette, 0, random, meshes);

    const glm::vec2 a = lot.corners[0].position, b = lot.corners[1].position;
    const glm::vec2 along = glm::normalize(b - a), middle = 0.5f * (a + b), out(along.y, -along.x);
    constexpr float porticoHalf = 8, porticoHeight = 11;
    for (int k = 0; k < 6; ++k) {
        const float s = -porticoHalf + 0.7f + static_cast<float>(k) * (2 * porticoHalf - 1.4f) / 5;
        const glm::vec2 p = middle + s * along + 1.05f * out;
        addTube(meshes.solid, {p, 0.5f}, {p, porticoHeight}, 0.5f, 0.42f, 12, palette.granite, 2);
    }
    addBox(meshes.solid, middle, along, {-porticoHalf - 0.4f, porticoHalf + 0.4f, 0, 1.8f, 0, 0.5f},
           palette.granite, boxAll & ~(boxBottom | boxBack), 2);
    addBox(meshes.solid, middle, along,
           {-porticoHalf, porticoHalf, -0.1f, 1.5f, porticoHeight, porticoHeight + 1.2f}, design.style.trim,
           boxAll & ~boxBack);
    addPediment(lot, porticoHeight + 1.2f, porticoHalf, 3.2f, design.style.trim, meshes.solid);

    const glm::vec2 towerFoot = middle - 7.0f * out;
    const auto ring = [&](float half) {
        return std::array<glm::vec2, 4>{
            towerFoot - half * along + half * out, towerFoot + half * along + half * out,
            towerFoot + half * along - half * out, towerFoot - half * along - half * out};
    };
    const float eaves = design.eaves();
    addPrism(meshes.solid, ring(4), eaves - 1, 33, design.style.blank, design.style.trim, 3);
    addPrism(meshes.solid, ring(4.5f), 33, 34, design.style.trim, design.style.trim, 3);
    addDeck(meshes.solid, ring(4.5f), 33, design.style.trim, 3, false);
    addDeck(meshes.solid, ring(3), 39, design.style.trim, 3, false);
    for (std::size_t k = 0; k < 4; ++k) {
        // A clock on each side.
        const glm::vec2 p = ring(4.06f)[k], q = ring(4.06f)[(k + 1) % 4], side = glm::normalize(q - p),
                        m = 0.5f * (p + q);
        std::array<glm::vec3, 12> face;
        for (std::size_t i = 0; i < 12; ++i) {
            const Turn turn(static_cast<double>(i) / 12);
            face[i] = {m + 1.7f * turn.cos * side, 30 + 1.7f * turn.sin};
        }
        for (std::size_t i = 1; i + 1 < 12; ++i)
            addFacet(meshes.solid, face[0], face[i], face[i + 1], palette.lampGlass);
    }
    addPrism(meshes.solid, ring(2.6f), 34, 39, design.style.blank, design.style.trim, 3);
    const auto eave = ring(3);
    for (std::size_t k = 0; k < 4; ++k)
        addFacet(meshes.solid, {eave[k], 39}, {eave[(k + 1) % 4], 39}, {towerFoot, 50}, palette.copper, 2);
}

/// Nave across the view, two towers with spires.
void addChurch(const Lot& lot, const Palette& palette, Random& random, HouseMeshes& meshes) {
    HouseDesign design;
    design.style = palette.facades[palette.firstGlassFacade - 6];
    design.storeys = 2;
    design.storeyHeight = 7;
    design.groundFloorHeight = 7;
    design.bayWidth = 5;
    design.roof = HouseRoof::gabled;
    design.roofMaterial = palette.roofTiles[3];
    design.roofHeight = 10;
    appendHouse(lot, design, palette, 0, random, meshes);
    const glm::vec2 a = lot.corners[0].position, b = lot.corners[1].position;
    const glm::vec2 along = glm::normalize(b - a), middle = 0.5f * (a + b), out(along.y, -along.x);
    for (const float s : {-8.0f, 8.0f}) {
        const glm::vec2 c = middle + s * along - 2.0f * out;
        const auto corner = [&](float half, std::size_t k) {
            const float u = k == 0 || k == 3 ? -half : half, v = k < 2 ? half : -half;
            return c + u * along + v * out;
        };
        const auto ring = [&](float half) {
            return std::array<glm::vec2, 4>{corner(half, 0), corner(half, 1), corner(half, 2),
                                            corner(half, 3)};
        };
        const auto tower = ring(3.6f);
        for (std::size_t k = 0; k < 4; ++k)
            addWall(meshes.solid, tower[k], tower[(k + 1) % 4], 0, 30, design.style.facade, 1, 4);
        addPrism(meshes.solid, ring(3.9f), 30, 30.8f, design.style.trim, design.style.trim, 3);
        addDeck(meshes.solid, ring(3.9f), 30, design.style.trim, 3, false);
        std::array<glm::vec2, 8> spire;
        for (std::size_t k = 0; k < 8; ++k) {
            const Turn turn((static_cast<double>(k) + 0.5) / 8);
            spire[k] = c + 3.6f * turn.cos * along - 3.6f * turn.sin * out;
        }
        // Counter-clockwise from above: along x out points down in this frame.
        for (std::size_t k = 0; k < 8; ++k)
            addFacet(meshes.solid, {spire[k], 30.8f}, {spire[(k + 1) % 8], 30.8f}, {c, 52}, palette.copper,
                     2);
    }
    addBox(meshes.solid, middle, along, {-2.4f, 2.4f, 0, 0.5f, 0, 6}, design.style.trim,
           boxAll & ~(boxBottom | boxBack));
    addBox(meshes.solid, middle, along, {-1.6f, 1.6f, 0.5f, 0.58f, 0, 4.8f}, palette.wood, boxFront);
}

}  // namespace

void addEdgeRows(const BoulevardPlan& plan, const Palette& palette, const Standing& standing, Random& random,
                 CityModel& model, ChunkCollector& chunks) {
    const float r = plan.ring;
    const float wide = r + houseLine(StreetRank::tramStreet), narrow = r + houseLine(StreetRank::street);
    // The tram's half of the ring is wider; west and east rows change line at the avenue, behind the
    // landmarks.
    struct Row {
        glm::vec2 start, along;
        float length;
        int landmark;  ///< 0 none, 1 town hall, 2 church at the row's end
    };
    const std::array<Row, 6> rows{{
        {{-wide, wide}, {1, 0}, 2 * wide, 0},
        {{wide, wide}, {0, -1}, wide - landmarkHalf, 0},
        {{narrow, -landmarkHalf}, {0, -1}, narrow - landmarkHalf, 0},
        {{narrow, -narrow}, {-1, 0}, 2 * narrow, 0},
        {{-narrow, -narrow}, {0, 1}, narrow - landmarkHalf, 0},
        {{-wide, landmarkHalf}, {0, 1}, wide - landmarkHalf, 0},
    }};
    BlockSide side;
    side.storeysLow = 4;
    side.storeysHigh = 6;
    side.shops = 0.35;
    side.ornament = 0.4;
    for (const Row& row : rows) {
        HouseMeshes meshes;
        float s = 0, lastEaves = 0;
        std::vector<PlannedHouse> houses;
        while (s < row.length - 0.5f) {
            float width = random.range(14, 24);
            if (row.length - s - width < 12)
                width = row.length - s > 26 ? 0.5f * (row.length - s) : row.length - s;
            PlannedHouse house{rowLot(row.start, row.along, s, s + width, houseDepth),
                               drawHouse(side, 0.06, palette, random)};
            houses.push_back(std::move(house));
            s += width;
        }
        for (std::size_t k = 0; k < houses.size(); ++k) {
            Lot& lot = houses[k].lot;
            lot.corners[3].hiddenBelow = lastEaves;
            lot.corners[1].hiddenBelow = k + 1 < houses.size() ? houses[k + 1].design.eaves() : 0;
            lastEaves = houses[k].design.eaves();
            HouseMeshes one;
            appendHouse(lot, houses[k].design, palette, 0, random, one);
            chunks.add(ChunkKind::building, one.solid);
            chunks.add(ChunkKind::furniture, one.details);
            // Ground from the pavement to the border.
            const glm::vec2 a = lot.corners[0].position, b = lot.corners[1].position, out = outward(a, b);
            const float deep = plan.half - std::max(std::abs(glm::dot(a, out)), 0.0f);
            if (deep > houseDepth) {
                const std::array<glm::vec2, 4> yard{a + 0.4f * out, b + 0.4f * out, b - deep * out,
                                                    a - deep * out};
                addDeck(chunks.at(ChunkKind::ground, lot.centre().x, lot.centre().y), yard, innerGround,
                        palette.grass, palette.repeat(palette.grass));
                if (deep > houseDepth + 12 && k % 3 == 0)
                    placeTree(model, standing.parkTrees,
                              {0.5f * (a + b) - (houseDepth + 7) * out, innerGround}, random);
            }
        }
    }
    for (const float x : {-1.0f, 1.0f}) {
        // A forecourt brings the landmark up to the narrower street's line.
        const glm::vec2 along(0, -x);
        const Lot lot = rowLot({x * wide, x * landmarkHalf}, along, 0, 2 * landmarkHalf, landmarkDepth, 0);
        HouseMeshes meshes;
        if (x > 0) {
            addTownHall(lot, palette, random, meshes);
        } else {
            addChurch(lot, palette, random, meshes);
        }
        chunks.add(ChunkKind::building, meshes.solid);
        chunks.add(ChunkKind::furniture, meshes.details);
        const float from = x * (narrow - 0.4f), to = x * plan.half;
        const std::array<glm::vec2, 4> court{{{std::min(from, to), -landmarkHalf},
                                              {std::max(from, to), -landmarkHalf},
                                              {std::max(from, to), landmarkHalf},
                                              {std::min(from, to), landmarkHalf}}};
        addDeck(chunks.at(ChunkKind::ground, x * wide, 0), court, innerGround, palette.slabs,
                palette.repeat(palette.slabs));
    }
}

}  // namespace city
