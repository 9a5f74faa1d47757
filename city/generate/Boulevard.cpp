#include "city/generate/Boulevard.h"

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>
#include <stdexcept>

#include "city/generate/BoulevardPlan.h"
#include "city/generate/ChunkCollector.h"
#include "city/generate/CityPlants.h"
#include "city/generate/EdgeRows.h"
#include "city/generate/HouseParts.h"
#include "city/generate/OpenSpaces.h"
#include "city/generate/Random.h"
#include "city/generate/SignalHeads.h"
#include "city/generate/SquareMirrors.h"
#include "city/generate/StreetFurnishing.h"
#include "city/generate/TourPath.h"
#include "city/roads/BuildRoadNetwork.h"
#include "city/roads/StreetSurfaces.h"

namespace city {

namespace {

constexpr double smallestSize = 200, largestSize = 2000;  // metres

BlockSide sideFor(StreetRank rank, Random& random) {
    BlockSide side;
    switch (rank) {
        case StreetRank::avenue:
            side = {6, 7, 0.95, 0.75};
            break;
        case StreetRank::tramStreet:
            side = {5, 6, 0.6, 0.5};
            break;
        case StreetRank::street:
            side = {4, 6, 0.45, 0.45};
            break;
        case StreetRank::lane:
            side = {4, 6, 0.4, 0.35};
            break;
    }
    if (random.chance(0.3)) ++side.storeysHigh;
    return side;
}

/// Houses of one block as chunks of their own. The ground of the block and its court too.
void addBlock(const BoulevardPlan::Block& block, const Palette& palette, const Standing& standing,
              Random& random, CityModel& model, ChunkCollector& chunks) {
    BlockPlan plan;
    plan.boundary = block.boundary;
    for (const StreetRank rank : block.sides) plan.sides.push_back(sideFor(rank, random));
    plan.chamfer = random.chance(0.7) ? random.range(3, 4.5f) : 0;
    const PlannedBlock planned = planPerimeterBlock(plan, palette, 0, random);
    if (planned.houses.empty()) {
        addPark(block.boundary, palette, standing, random, model, chunks);
        return;
    }
    HouseMeshes meshes;
    for (const PlannedHouse& house : planned.houses) {
        appendHouse(house.lot, house.design, palette, 0, random, meshes);
        if (house.design.roof == HouseRoof::mansard || house.design.roof == HouseRoof::gabled) {
            const glm::vec2 along =
                glm::normalize(house.lot.corners[1].position - house.lot.corners[0].position);
            const float shift = (random.chance(0.5) ? 0.32f : -0.32f) * house.lot.length(0);
            const float eaves = house.design.eaves();
            appendChimney(house.lot.centre() + shift * along, along, eaves,
                          eaves + house.design.roofHeight + 1.1f, house.design.style.blank, meshes.solid);
        }
    }
    chunks.addWhole(ChunkKind::building, std::move(meshes.solid));
    chunks.addWhole(ChunkKind::furniture, std::move(meshes.details));
    addBlockGround(block.boundary, palette.cobbles, palette, chunks);
    addCourt(planned.court, palette, standing, random, model, chunks);
}

/// East along the median at car height, over the crossings, to the square, and round its fountain.
std::vector<TourStop> boulevardTour(const BoulevardPlan& plan) {
    // Between the trams (their sides at 3.35 m from the axis) and the cars (theirs at 4.65 m).
    constexpr float y = 3.95f;
    std::vector<float> crossings;
    const glm::vec2 square = plan.square;
    for (const BoulevardPlan::Street& street : plan.streets) {
        if (street.rank == StreetRank::avenue) crossings.push_back(street.from.x);
    }
    std::vector<TourKey> keys;
    const float stop = square.x - 30;
    const auto add = [&](float x, float z, float speed) {
        keys.push_back({{x, y, z}, {x + 28, y + 1.2f, 0.4f * z + 0.8f}, speed});
    };
    const float start = std::max(-plan.ring + 26, stop - 190);
    add(start, 1.5f, 8);
    bool high = false;  // over the last crossing already on the way up to the square
    for (const float x : crossings) {
        if (x < start + 40 || x > square.x - 20) continue;
        add(x - 34, 1.5f, 9);
        add(x - 16, 5, 9);
        add(x, 6, 9);
        high = x + 34 > stop;
        if (high) break;
        add(x + 16, 5, 9);
        add(x + 34, 1.5f, 8);
    }
    if (!high) add(stop - 6, 1.7f, 6);
    const float front = houseLine(StreetRank::avenue);
    keys.push_back({{square.x - 14, y + 2, 5.5f}, {square.x, front, 2}, 6});
    keys.push_back({{square.x - 5, front - 5, 7}, {square.x + 1, square.y - 11, 2.5f}, 6});
    keys.push_back({{square.x - 5, front + 6, 5}, {square.x, square.y - 11, 2.5f}, 6});
    keys.push_back({{square.x + 10, square.y - 24, 2.4f}, {square.x - 4, square.y - 2, 3}, 5});
    keys.push_back({{square.x + 10.5f, square.y - 11, 2.2f}, {square.x - 6, square.y - 14, 3}, 5});
    keys.push_back({{square.x + 8, square.y + 1, 4.5f}, {square.x - 3, front - 8, 1.5f}, 5});
    keys.push_back({{square.x + 3, square.y + 5, 8}, {square.x - 1, front - 12, 1.0f}, 5});
    return makeTour(keys);
}

}  // namespace

CityModel generateBoulevard(const BoulevardOptions& options) {
    if (!(options.size >= smallestSize && options.size <= largestSize)) {
        throw std::invalid_argument("boulevard: a size of " + std::to_string(options.size) +
                                    " m; it must be 200 to 2000");
    }
    const Random seed(options.seed);
    Random planRandom = seed.fork(1), prototypes = seed.fork(2), streets = seed.fork(3), edges = seed.fork(4),
           hills = seed.fork(5), mirrors = seed.fork(6);
    const BoulevardPlan plan = planBoulevard(options.size, planRandom);
    Palette palette = makePalette();
    addStoneShops(palette);
    CityModel model;
    model.name = "boulevard";
    const Standing standing = addPrototypes(palette, prototypes, model);
    model.roads = buildRoadNetwork(plan.graph);

    ChunkCollector chunks(80);
    for (Mesh& mesh : buildStreetSurfaces(plan.graph, palette.streets, 100)) {
        for (Vertex& v : mesh.vertices) v.texcoord /= palette.repeat(v.material);
        chunks.addWhole(ChunkKind::ground, std::move(mesh));
    }
    for (std::size_t k = 0; k < plan.blocks.size(); ++k) {
        Random random = seed.fork(100 + k);
        const BoulevardPlan::Block& block = plan.blocks[k];
        switch (block.use) {
            case BlockUse::houses:
                addBlock(block, palette, standing, random, model, chunks);
                break;
            case BlockUse::square:
                addSquare(block.boundary, palette, standing, random, model, chunks);
                break;
            case BlockUse::park:
                addPark(block.boundary, palette, standing, random, model, chunks);
                break;
        }
    }
    addEdgeRows(plan, palette, standing, edges, model, chunks);
    furnishStreets(plan, palette, standing, streets, model, chunks);

    SignalLayout signals = layOutSignals(model.roads);
    for (const SignalPole& pole : signals.poles)
        place(model, standing.signalPole, pole.foot, glm::vec2(pole.facing));
    model.signalHeads = std::move(signals.heads);

    model.tour = boulevardTour(plan);
    for (const BoulevardPlan::Block& block : plan.blocks)
        if (block.use == BlockUse::square)
            addSquareMirrors(block.boundary, model.tour, palette, mirrors, model, chunks);

    model.chunks = chunks.take();
    // The border bounds the city; the hills beyond are scenery.
    for (const Chunk& chunk : model.chunks) model.bounds.extend(chunk.bounds);
    for (const Placement& placement : model.placements) {
        model.bounds.extend(glm::vec3(placement.worldFromPrototype[3]) + glm::vec3(0, 0, 16));
    }
    addSurroundings(plan.half, palette, hills, model.chunks);
    model.materials = std::move(palette.materials);
    return model;
}

}  // namespace city
