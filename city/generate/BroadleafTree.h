#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "city/model/CityModel.h"

namespace city {

/// A deciduous tree with modelled leaves (no cut-out pictures: every method of drawing
/// and tracing sees the same tree).
struct TreeShape {
    float height = 12;         ///< metres, foot to top
    float crownBase = 3;       ///< metres above the foot where the leaves begin
    float crownRadius = 3.5f;  ///< metres
    float trunkRadius = 0.2f;  ///< metres at breast height
    int boughs = 9;
    int clusters = 160;      ///< tufts of leaves
    float leafCoverage = 4;  ///< one-sided leaf area over the crown's ground area
    std::uint32_t bark = 0;
    std::uint32_t core = 0;  ///< material of the shaded inside, for levels that cannot fill it with leaves
    std::uint32_t foliage[3] = {0, 0, 0};  ///< materials of leaves, mixed
};

/// Levels with exactly the asked numbers of triangles (finest first, each at least 20). A coarser level
/// leaves out twigs and leaves and enlarges the leaves that stay, so that area, volume and colour of the
/// crown remain. Level::error is six tenths of its leaves' length.
Prototype makeBroadleafTree(std::string name, const TreeShape& shape, std::span<const std::size_t> triangles,
                            std::uint64_t seed);

}  // namespace city
