#pragma once

#include <cstdint>
#include <vector>

#include "city/generate/PerimeterBlock.h"
#include "city/roads/StreetGraph.h"

namespace city {

enum class StreetRank : std::uint8_t { avenue, tramStreet, street, lane };

enum class BlockUse : std::uint8_t { houses, square, park };

/// Where the boulevard city's streets and blocks lie.
///
///     ring street with a tram (north)
///     +----+----+----+----+----+
///     |    |    |    |    |    |      blocks between streets that are not quite parallel;
///     +----+----+----+----+----+      one block is the square, one a park
///     |    |    | sq |    |    |
///     +====+====+====+====+====+      avenue, tram in its median, y = 0
///     |    |    |    |    |    |
///     +----+----+----+----+----+      ring street (south); houses stand all round outside the ring
struct BoulevardPlan {
    struct Block {
        BlockUse use = BlockUse::houses;
        std::vector<glm::vec2> boundary;  ///< convex, counter-clockwise, at the pavements' inner edges
        std::vector<StreetRank> sides;    ///< what runs along side i
    };
    struct Street {
        StreetRank rank = StreetRank::street;
        glm::vec2 from{0}, to{0};
        float trimFrom = 0, trimTo = 0;  ///< metres that crossings take at the ends, up to their houses
    };
    StreetGraph graph;
    std::vector<Street> streets;  ///< one per edge of the graph
    std::vector<Block> blocks;
    glm::vec2 square{0};  ///< middle of the square
    float ring = 0;       ///< metres; the ring's axes are x = +-ring and y = +-ring
    float half = 0;       ///< metres; the city's border
};

/// Half the carriageway, axis to kerb, and axis to houses.
float kerbLine(StreetRank rank);
float houseLine(StreetRank rank);
float pavementWidth(StreetRank rank);

/// `size`: side of the city in metres, 200 to 2000.
BoulevardPlan planBoulevard(double size, Random& random);

}  // namespace city
