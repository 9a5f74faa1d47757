#include "city/generate/CityPlants.h"

#include <array>

#include "city/generate/BroadleafTree.h"
#include "city/generate/Furniture.h"
#include "city/generate/Random.h"

namespace city {

namespace {

TreeShape leafy(const Palette& palette, float height, float crownBase, float crownRadius, float trunkRadius,
                bool dark) {
    TreeShape shape;
    shape.height = height;
    shape.crownBase = crownBase;
    shape.crownRadius = crownRadius;
    shape.trunkRadius = trunkRadius;
    shape.bark = palette.bark;
    shape.core = palette.foliageShade;
    shape.foliage[0] = dark ? palette.foliageDark : palette.foliageBright;
    shape.foliage[1] = palette.foliageDark;
    shape.foliage[2] = dark ? palette.foliageBright : palette.foliageWarm;
    shape.clusters = 130;
    shape.leafCoverage = 3.6f;
    return shape;
}

}  // namespace

Standing addPrototypes(const Palette& palette, Random& random, CityModel& model) {
    Standing standing;
    const auto add = [&](Prototype prototype) {
        model.prototypes.push_back(std::move(prototype));
        return static_cast<std::uint32_t>(model.prototypes.size() - 1);
    };
    constexpr std::array<std::size_t, 4> levels{4400, 1500, 500, 120};
    constexpr std::array<std::size_t, 4> smallLevels{1800, 700, 240, 72};
    for (int k = 0; k < 2; ++k) {
        standing.avenueTrees.push_back(add(makeBroadleafTree(
            "lime tree", leafy(palette, 10.8f, 2.9f, 2.9f, 0.2f, false), levels, random.next())));
        standing.parkTrees.push_back(add(makeBroadleafTree(
            "park tree", leafy(palette, 12.5f + static_cast<float>(k), 2.2f, 3.6f, 0.27f, k == 1), levels,
            random.next())));
    }
    standing.streetTrees.push_back(add(makeBroadleafTree(
        "hornbeam", leafy(palette, 7.2f, 2.4f, 1.9f, 0.12f, true), smallLevels, random.next())));
    standing.streetLamp = add(makeStreetLamp(palette));
    standing.squareLamp = add(makeSquareLamp(palette));
    standing.signalPole = add(makeSignalPole(palette));
    standing.bench = add(makeBench(palette));
    standing.bollard = add(makeBollard(palette));
    standing.bin = add(makeLitterBin(palette));
    standing.shelter = add(makeTramShelter(palette));
    standing.mast = add(makeCatenaryMast(palette));
    standing.kiosk = add(makeKiosk(palette));
    standing.fountain = add(makeFountain(palette));
    standing.monument = add(makeMonument(palette));
    for (std::size_t k = 0; k < 3; ++k)
        standing.advertColumns.push_back(add(makeAdvertColumn(palette, 2 * k + 1)));
    return standing;
}

void place(CityModel& model, std::uint32_t prototype, const glm::vec3& foot, const glm::vec2& front,
           float scale) {
    model.placements.push_back({prototype, standing(foot, front, scale)});
}

void placeTree(CityModel& model, const std::vector<std::uint32_t>& trees, const glm::vec3& foot,
               Random& random) {
    const Turn turn(random.uniform());
    const std::uint32_t tree = trees[random.index(trees.size())];
    place(model, tree, foot, {turn.cos, turn.sin}, random.range(0.9f, 1.08f));
}

}  // namespace city
