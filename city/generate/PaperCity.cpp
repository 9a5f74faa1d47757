#include "city/generate/PaperCity.h"

#include <algorithm>
#include <array>
#include <stdexcept>

#include "city/generate/BroadleafTree.h"
#include "city/generate/ChunkCollector.h"
#include "city/generate/Furniture.h"
#include "city/generate/HouseParts.h"
#include "city/generate/PaperStreets.h"
#include "city/generate/PerimeterBlock.h"
#include "city/generate/Random.h"
#include "city/generate/Shapes.h"
#include "city/generate/SignalHeads.h"
#include "city/generate/TourPath.h"
#include "city/roads/BuildRoadNetwork.h"

namespace city {

namespace {

using L = PaperLayout;

// Meyer & Loscos 2003, section 7.
constexpr std::size_t allTriangles = 500000;
constexpr std::size_t buildingTriangles = 25600;
constexpr std::size_t treeTriangles = 59100;
constexpr std::size_t treeCount = 8;
constexpr std::size_t otherTriangles = allTriangles - buildingTriangles - treeCount * treeTriangles;

constexpr std::size_t chimneyTriangles = 10;

/// The houses of the middle block stand this far behind the pavement, in metres, behind the trees.
constexpr float gardenDepth = 17;

/// All houses of the city in one order, with the block each belongs to.
struct Houses {
    std::vector<PlannedHouse> planned;
    std::vector<std::size_t> block;
    std::size_t blocks = 0;
};

Houses planHouses(const Palette& palette, const Random& seed) {
    Houses houses;
    for (int j = -1; j < L::lines; ++j) {
        for (int i = -1; i < L::lines; ++i) {
            const bool square = i == 1 && j == 1;
            Random random =
                seed.fork(8 * static_cast<std::uint64_t>(j + 1) + static_cast<std::uint64_t>(i + 1));
            const auto low = [](int k) { return k < 0 ? -L::half + 2 : L::line(k) + L::houseLine; };
            const auto high = [](int k) {
                return k + 1 >= L::lines ? L::half - 2 : L::line(k + 1) - L::houseLine;
            };
            const bool inner = i >= 0 && j >= 0 && i + 1 < L::lines && j + 1 < L::lines;
            BlockPlan plan;
            plan.boundary = {{low(i), low(j)}, {high(i), low(j)}, {high(i), high(j)}, {low(i), high(j)}};
            if (square) plan.boundary = insetRing(plan.boundary, gardenDepth);
            plan.depth = inner ? 15 : 13;
            plan.frontLow = inner ? 17.0f : 22.0f;
            plan.frontHigh = inner ? 30.0f : 36.0f;
            plan.glass = 0.12;
            const int tall = random.integer(4, 6);
            BlockSide side;
            side.storeysLow = tall - 1;
            side.storeysHigh = tall + 2;
            side.shops = inner ? 0.6 : 0.3;
            side.ornament = inner ? 0.6 : 0.2;
            plan.sides.assign(4, side);
            for (PlannedHouse& house : planPerimeterBlock(plan, palette, 0, random).houses) {
                houses.planned.push_back(std::move(house));
                houses.block.push_back(houses.blocks);
            }
            ++houses.blocks;
        }
    }
    return houses;
}

/// Takes off ornament, dearest first; false when none is left.
bool simplify(HouseDesign& design) {
    for (bool* part :
         {&design.balconies, &design.awnings, &design.bayWindow, &design.dormers, &design.cornice}) {
        if (*part) {
            *part = false;
            return true;
        }
    }
    if (design.shops) {
        design.shops = false;
        return true;
    }
    return false;
}

std::size_t triangles(const HouseMeshes& meshes) {
    return meshes.solid.triangleCount() + meshes.details.triangleCount();
}

/// Builds every house as richly as its share of the triangles allows, then spends what is left on chimneys
/// and roof lights, so that the sum is exact.
void addHouses(Houses houses, const Palette& palette, const Random& seed, ChunkCollector& chunks) {
    std::vector<HouseMeshes> blocks(houses.blocks);
    const std::size_t count = houses.planned.size();
    const std::size_t reserve = 2 * count;  // for chimneys: one house in five
    std::size_t used = 0;
    for (std::size_t k = 0; k < count; ++k) {
        const std::size_t allowance = (buildingTriangles - reserve) * (k + 1) / count;
        HouseDesign design = houses.planned[k].design;
        HouseMeshes meshes;
        do {
            meshes = {};
            Random random = seed.fork(5000 + k);
            appendHouse(houses.planned[k].lot, design, palette, 0, random, meshes);
        } while (used + triangles(meshes) > allowance && simplify(design));
        used += triangles(meshes);
        houses.planned[k].design = design;
        HouseMeshes& block = blocks[houses.block[k]];
        block.solid.append(meshes.solid);
        block.details.append(meshes.details);
    }
    if (used > buildingTriangles || (buildingTriangles - used) % 2 != 0) {
        throw std::logic_error("paper city: the houses take " + std::to_string(used) + " triangles");
    }
    // Chimneys on houses in turn, at different places along the ridge; the odd rest as roof lights.
    for (std::size_t k = 0; count > 0 && used + chimneyTriangles <= buildingTriangles; ++k) {
        const std::size_t round = k / count;
        const PlannedHouse& house = houses.planned[(k * 7) % count];
        const glm::vec2 a = house.lot.corners[0].position, b = house.lot.corners[1].position;
        const glm::vec2 along = -glm::vec2(outward(a, b).y, -outward(a, b).x);
        const float shift = (0.3f - 0.15f * static_cast<float>(round)) * house.lot.length(0);
        const float eaves = house.design.eaves();
        const bool tent = house.design.roof == HouseRoof::tent;
        const float rise =
            house.design.roof == HouseRoof::flat ? 0 : (tent ? 0.5f : 1.0f) * house.design.roofHeight;
        appendChimney(house.lot.centre() + shift * along, along, eaves, eaves + rise + 1.2f,
                      palette.roofTiles[1], blocks[houses.block[(k * 7) % count]].solid);
        used += chimneyTriangles;
    }
    // The odd rest: house numbers beside the doors.
    for (std::size_t k = 0; used < buildingTriangles; ++k, used += 2) {
        const Lot& lot = houses.planned[k].lot;
        const glm::vec2 a = lot.corners[0].position, b = lot.corners[1].position;
        const glm::vec2 out = outward(a, b), along(-out.y, out.x), p = a + 1.2f * along + 0.14f * out;
        addWall(blocks[houses.block[k]].details, p, p + 0.4f * along, 2.2f, 2.5f, palette.signs[1], 1, 1);
    }
    for (HouseMeshes& block : blocks) {
        ChunkCollector pieces(125);
        // Blocks of 230 m are too big to be culled well: cut at triangle pairs by where they lie.
        const auto split = [&](const Mesh& mesh, ChunkKind kind) {
            for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
                const Vertex &a = mesh.vertices[mesh.indices[t]], &b = mesh.vertices[mesh.indices[t + 1]],
                             &c = mesh.vertices[mesh.indices[t + 2]];
                const glm::vec3 centre = (a.position + b.position + c.position) / 3.0f;
                pieces.at(kind, centre.x + L::half, centre.y + L::half).addTriangle(a, b, c);
            }
        };
        split(block.solid, ChunkKind::building);
        split(block.details, ChunkKind::furniture);
        for (Chunk& chunk : pieces.take()) chunks.addWhole(chunk.kind, std::move(chunk.mesh));
    }
}

void addTrees(CityModel& model, const Palette& palette, Random& random) {
    TreeShape shape;
    shape.height = 13.5f;
    shape.crownBase = 3.2f;
    shape.crownRadius = 5;
    shape.trunkRadius = 0.34f;
    shape.boughs = 13;
    shape.clusters = 420;
    shape.leafCoverage = 4.2f;
    shape.bark = palette.bark;
    shape.core = palette.foliageShade;
    shape.foliage[0] = palette.foliageBright;
    shape.foliage[1] = palette.foliageDark;
    shape.foliage[2] = palette.foliageWarm;
    constexpr std::array<std::size_t, 5> levels{treeTriangles, 8000, 1500, 300, 60};
    model.prototypes.push_back(makeBroadleafTree("broad-leaved tree", shape, levels, random.next()));
    // Two on each side of the middle block, between its houses and the street, clear of the lanes.
    constexpr float row = L::spacing / 2 - L::houseLine - 6;
    for (const float along : {-38.0f, 38.0f}) {
        for (const glm::vec2 place : {glm::vec2(along, -row), glm::vec2(row, along), glm::vec2(-along, row),
                                      glm::vec2(-row, -along)}) {
            const Turn turn(random.uniform());
            model.placements.push_back(
                {0, standing({place, L::kerbHeight}, {turn.cos, turn.sin}, random.range(0.92f, 1.06f))});
        }
    }
}

std::vector<TourStop> paperTour() {
    // Along the southern side of the middle block, then north along its eastern side: at the kerb, high over
    // the crossings.
    const float p = L::line(1) + L::kerbLine + 1.6f, q = L::line(2) - L::kerbLine - 1.6f;
    const std::array<TourKey, 12> keys{{
        {{-240, p, 1.7f}, {-190, p - 6, 1.4f}, 9},
        {{-200, p, 1.7f}, {-150, p - 7, 1.4f}, 10},
        {{-155, p, 5}, {-110, p - 8, 1}, 11},
        {{-105, p, 6}, {-60, p - 8, 1}, 11},
        {{-60, p, 2}, {-20, p - 6, 1.2f}, 9},
        {{-10, p, 1.6f}, {30, p - 5, 1.2f}, 9},
        {{50, p, 3}, {100, p - 6, 2}, 10},
        {{96, p, 7}, {140, p + 5, 1}, 9},
        {{q, -90, 7.5f}, {q + 8, -40, 1}, 9},
        {{q, -40, 2.5f}, {q + 6, 10, 1.4f}, 10},
        {{q, 20, 1.7f}, {q + 5, 65, 1.4f}, 10},
        {{q, 85, 6}, {q + 8, 130, 1}, 9},
    }};
    return makeTour(keys);
}

}  // namespace

CityModel generatePaperCity(std::uint64_t seed) {
    const Random random(seed);
    Palette palette = makePalette();
    CityModel model;
    model.name = "paper";
    model.roads = buildRoadNetwork(paperStreetGraph());
    ChunkCollector chunks;
    addPaperStreets(model.roads, palette, otherTriangles, chunks);
    addHouses(planHouses(palette, random), palette, random, chunks);
    Random trees = random.fork(1000);
    addTrees(model, palette, trees);
    model.signalHeads = layOutSignals(model.roads).heads;
    model.chunks = chunks.take();
    model.materials = std::move(palette.materials);
    for (const Chunk& chunk : model.chunks) model.bounds.extend(chunk.bounds);
    model.bounds.max.z = std::max(model.bounds.max.z, 15.0f);
    model.tour = paperTour();
    return model;
}

}  // namespace city
