#include "city/generate/BoulevardPlan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "city/generate/Random.h"

namespace city {

namespace {

constexpr float laneWidth = 3.25f;
constexpr float border = 45;  // metres between the ring's axis and the city's border: pavement, houses, yards
constexpr float blockAlong = 102;   // metres between streets across the avenue, about
constexpr float blockAcross = 122;  // metres between streets along the avenue, about

struct RankMeasures {
    int lanes;       ///< each way
    float median;    ///< metres
    float pavement;  ///< metres
    float speed;     ///< metres per second
};
// Avenue 36 m from house to house, streets 14 to 24 m: whole metres from axis to houses, so that the fronts
// that run along the map's axes lie on the borders of one-metre heightfield cells.
constexpr RankMeasures measures(StreetRank rank) {
    switch (rank) {
        case StreetRank::avenue:
            return {2, 8, 7.5f, 13.9f};
        case StreetRank::tramStreet:
            return {1, 8, 4.75f, 11.1f};
        case StreetRank::street:
            return {1, 0, 4.75f, 8.33f};
        case StreetRank::lane:
            return {1, 0, 3.75f, 8.33f};
    }
    return {1, 0, 3.75f, 8.33f};
}

/// The grid of crossings: columns 0..columns, rows -rows..rows.
struct Grid {
    int columns, rows;
    std::vector<glm::vec2> nodes;
    std::size_t index(int i, int j) const {
        return static_cast<std::size_t>(j + rows) * static_cast<std::size_t>(columns + 1) +
               static_cast<std::size_t>(i);
    }
    glm::vec2 at(int i, int j) const { return nodes[index(i, j)]; }
};

Grid makeGrid(float ring, Random& random) {
    Grid grid;
    grid.columns = std::max(1, static_cast<int>(std::round(2 * ring / blockAlong)));
    if (grid.columns % 2 == 0) ++grid.columns;  // the square lies in the middle column
    grid.rows = std::max(1, static_cast<int>(std::round(ring / blockAcross)));
    for (int j = -grid.rows; j <= grid.rows; ++j) {
        for (int i = 0; i <= grid.columns; ++i) {
            glm::vec2 p(-ring + 2 * ring * static_cast<float>(i) / static_cast<float>(grid.columns),
                        ring * static_cast<float>(j) / static_cast<float>(grid.rows));
            // Old towns are not ruled: streets inside the ring lean a little. The avenue is straight.
            const bool inside = i > 0 && i < grid.columns;
            const float sway = 0.085f * blockAlong;
            if (inside) p.x += random.range(-sway, sway);
            if (inside && j != 0 && std::abs(j) < grid.rows) p.y += random.range(-sway, sway);
            grid.nodes.push_back(p);
        }
    }
    return grid;
}

StreetRank rowRank(const Grid& grid, int j) {
    if (j == 0) return StreetRank::avenue;
    return j == grid.rows ? StreetRank::tramStreet : StreetRank::street;
}

/// Rank of the street from (i, j) to (i, j + 1).
StreetRank columnRank(const Grid& grid, int i, int j) {
    const bool outer = i == 0 || i == grid.columns;
    return outer && j >= 0 ? StreetRank::tramStreet : outer ? StreetRank::street : StreetRank::lane;
}

}  // namespace

float kerbLine(StreetRank rank) {
    const RankMeasures m = measures(rank);
    return 0.5f * m.median + static_cast<float>(m.lanes) * laneWidth;
}
float pavementWidth(StreetRank rank) {
    return measures(rank).pavement;
}
float houseLine(StreetRank rank) {
    return kerbLine(rank) + pavementWidth(rank);
}

BoulevardPlan planBoulevard(double size, Random& random) {
    BoulevardPlan plan;
    plan.half = static_cast<float>(0.5 * size);
    plan.ring = plan.half - border;
    const Grid grid = makeGrid(plan.ring, random);

    for (int j = -grid.rows; j <= grid.rows; ++j) {
        for (int i = 0; i <= grid.columns; ++i) {
            const bool corner = (i == 0 || i == grid.columns) && std::abs(j) == grid.rows;
            const bool tram = j == 0 || j == grid.rows || ((i == 0 || i == grid.columns) && j > 0);
            plan.graph.nodes.push_back({glm::vec3(grid.at(i, j), 0), tram && !corner});
        }
    }
    const auto addStreet = [&](int i, int j, int i2, int j2, StreetRank rank, StreetRank crossingFrom,
                               StreetRank crossingTo, std::string name) {
        const RankMeasures m = measures(rank);
        StreetGraph::Edge e;
        e.from = static_cast<std::uint32_t>(grid.index(i, j));
        e.to = static_cast<std::uint32_t>(grid.index(i2, j2));
        e.shape = {plan.graph.nodes[e.from].position, plan.graph.nodes[e.to].position};
        e.lanesForward = e.lanesBackward = m.lanes;
        e.laneWidth = laneWidth;
        e.medianWidth = m.median;
        e.pavementWidth = m.pavement;
        e.tram = m.median > 0;
        e.speedLimit = m.speed;
        e.name = std::move(name);
        plan.graph.edges.push_back(std::move(e));
        plan.streets.push_back(
            {rank, grid.at(i, j), grid.at(i2, j2), houseLine(crossingFrom), houseLine(crossingTo)});
    };
    for (int j = -grid.rows; j <= grid.rows; ++j) {
        for (int i = 0; i < grid.columns; ++i) {
            const int below = std::max(j - 1, -grid.rows);
            const auto crossing = [&](int column) {
                const StreetRank up = columnRank(grid, column, std::min(j, grid.rows - 1)),
                                 down = columnRank(grid, column, below);
                return houseLine(up) > houseLine(down) ? up : down;
            };
            const std::string name = j == 0 ? "Avenue" : "Street " + std::to_string(j);
            addStreet(i, j, i + 1, j, rowRank(grid, j), crossing(i), crossing(i + 1), name);
        }
    }
    for (int i = 0; i <= grid.columns; ++i) {
        for (int j = -grid.rows; j < grid.rows; ++j) {
            addStreet(i, j, i, j + 1, columnRank(grid, i, j), rowRank(grid, j), rowRank(grid, j + 1),
                      "Cross street " + std::to_string(i + 1));
        }
    }

    const int parkColumn = std::max(0, grid.columns - 2), parkRow = -grid.rows;
    for (int j = -grid.rows; j < grid.rows; ++j) {
        for (int i = 0; i < grid.columns; ++i) {
            BoulevardPlan::Block block;
            block.sides = {rowRank(grid, j), columnRank(grid, i + 1, j), rowRank(grid, j + 1),
                           columnRank(grid, i, j)};
            std::array<float, 4> distances{};
            for (std::size_t k = 0; k < 4; ++k) distances[k] = houseLine(block.sides[k]);
            block.boundary = insetRing(
                {grid.at(i, j), grid.at(i + 1, j), grid.at(i + 1, j + 1), grid.at(i, j + 1)}, distances);
            if (block.boundary.empty()) continue;
            if (i == grid.columns / 2 && j == 0) {
                block.use = BlockUse::square;
                for (const glm::vec2& p : block.boundary) plan.square += 0.25f * p;
            }
            if (grid.rows > 1 && i == parkColumn && j == parkRow) block.use = BlockUse::park;
            plan.blocks.push_back(std::move(block));
        }
    }
    return plan;
}

}  // namespace city
