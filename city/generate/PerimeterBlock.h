#pragma once

#include <span>
#include <vector>

#include "city/generate/House.h"

namespace city {

/// How the houses of one side of a block are chosen.
struct BlockSide {
    int storeysLow = 4, storeysHigh = 6;
    double shops = 0.5;     ///< share of houses with shop fronts
    double ornament = 0.5;  ///< share of houses with balconies, bay windows, dormers
};

struct BlockPlan {
    std::vector<glm::vec2> boundary;      ///< convex, counter-clockwise; side i from corner i to corner i + 1
    std::vector<BlockSide> sides;         ///< one per side
    float depth = 13;                     ///< metres from street to court
    float frontLow = 13, frontHigh = 24;  ///< metres of street a house takes
    float chamfer = 0;                    ///< metres cut from the block's corners; 0: sharp corners
    double glass = 0.06;                  ///< share of modern houses
};

struct PlannedHouse {
    Lot lot;
    HouseDesign design;
};

struct PlannedBlock {
    std::vector<PlannedHouse> houses;
    std::vector<glm::vec2> court;  ///< ring of the courtyard; empty when the block has none
};

/// Houses all round a block, wall to wall, with a courtyard: the European perimeter block. The depth shrinks
/// where the block is narrow; a block with no room for houses comes back empty. `base` is the world z of the
/// houses' foot.
PlannedBlock planPerimeterBlock(const BlockPlan& plan, const Palette& palette, float base, Random& random);

/// A house drawn at random: style, roof, storeys, shops.
HouseDesign drawHouse(const BlockSide& side, double glass, const Palette& palette, Random& random);

/// Ring moved inwards by `distance` on every side; empty where nothing is left. Convex counter-clockwise
/// rings.
std::vector<glm::vec2> insetRing(const std::vector<glm::vec2>& ring, float distance);
/// The same with a distance for every side.
std::vector<glm::vec2> insetRing(const std::vector<glm::vec2>& ring, std::span<const float> distances);

}  // namespace city
