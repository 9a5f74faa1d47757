#include "reflection/chrome/BoundingGrid.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace reflection {

namespace {

struct Division {
    glm::vec3 low{0};
    glm::vec3 cell{1};  ///< sides of a cell
    glm::ivec3 cells{1};

    glm::ivec3 cellOf(const glm::vec3& p) const {
        glm::ivec3 c;
        for (int a = 0; a < 3; ++a) {
            const float x = (p[a] - low[a]) / cell[a];
            // False for NaN too.
            c[a] = x > 0 ? std::min(static_cast<int>(x), cells[a] - 1) : 0;
        }
        return c;
    }
};

/// 21 bits an axis: more cells than any budget of nodes can ask for.
constexpr int mostCells = 1 << 20;

std::uint64_t keyOf(const glm::ivec3& c) {
    return (static_cast<std::uint64_t>(c.z) << 42) | (static_cast<std::uint64_t>(c.y) << 21) |
           static_cast<std::uint64_t>(c.x);
}

Division divide(const glm::vec3& low, const glm::vec3& extent, float side) {
    Division d;
    d.low = low;
    for (int a = 0; a < 3; ++a) {
        d.cells[a] = std::clamp(static_cast<int>(std::ceil(extent[a] / side)), 1, mostCells);
        d.cell[a] = extent[a] > 0 ? extent[a] / static_cast<float>(d.cells[a]) : 1.0f;
    }
    return d;
}

constexpr std::array<glm::ivec3, 8> corners{
    {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}}};

std::size_t countNodes(std::span<const glm::vec3> positions, const Division& d) {
    std::unordered_map<std::uint64_t, char> cells, nodes;
    for (const glm::vec3& p : positions) {
        const glm::ivec3 c = d.cellOf(p);
        if (!cells.try_emplace(keyOf(c)).second) continue;
        for (const glm::ivec3& k : corners) nodes.try_emplace(keyOf(c + k));
    }
    return nodes.size();
}

}  // namespace

BoundingGrid::BoundingGrid(std::span<const glm::vec3> positions, std::size_t mostNodes) {
    glm::vec3 low(INFINITY), high(-INFINITY);
    for (const glm::vec3& p : positions)
        for (int a = 0; a < 3; ++a)
            if (std::isfinite(p[a])) low[a] = std::min(low[a], p[a]), high[a] = std::max(high[a], p[a]);
    for (int a = 0; a < 3; ++a)
        if (!(low[a] <= high[a])) low[a] = high[a] = 0;
    const glm::vec3 extent = high - low;
    const float longest = std::max({extent.x, extent.y, extent.z, 1e-30f});

    // Nodes grow as cells shrink, though not at every step: the smallest side seen that keeps the budget
    // wins.
    float fine = longest / 1024, coarse = longest;
    for (int k = 0; k < 20; ++k) {
        const float middle = std::sqrt(fine * coarse);
        (countNodes(positions, divide(low, extent, middle)) <= mostNodes ? coarse : fine) = middle;
    }
    size = coarse;
    const Division d = divide(low, extent, size);
    std::unordered_map<std::uint64_t, std::uint32_t> cellIds, nodeIds;
    inside.reserve(positions.size());
    for (const glm::vec3& p : positions) {
        const glm::ivec3 c = d.cellOf(p);
        const auto [cell, added] = cellIds.try_emplace(keyOf(c), static_cast<std::uint32_t>(used.size()));
        if (added) {
            Cell made{};
            for (std::size_t k = 0; k < 8; ++k) {
                const glm::ivec3 n = c + corners[k];
                const auto [node, fresh] =
                    nodeIds.try_emplace(keyOf(n), static_cast<std::uint32_t>(points.size()));
                if (fresh) points.push_back(low + d.cell * glm::vec3(n));
                made.nodes[k] = node->second;
            }
            used.push_back(made);
        }
        glm::vec3 within = (p - low) / d.cell - glm::vec3(c);
        for (int a = 0; a < 3; ++a) within[a] = within[a] > 0 ? std::min(within[a], 1.0f) : 0.0f;
        inside.push_back({cell->second, within});
    }
}

void BoundingGrid::interpolate(std::span<const glm::vec4> atNodes, std::span<glm::vec4> atVertices) const {
    // Four floats at a time, written so that the compiler keeps them in one register.
    using Four = float __attribute__((vector_size(16)));
    const auto at = [&](std::uint32_t n) {
        Four f;
        __builtin_memcpy(&f, &atNodes[n], sizeof f);
        return f;
    };
    const auto mix = [](Four a, Four b, float t) { return a + t * (b - a); };
    for (std::size_t k = 0; k < inside.size(); ++k) {
        const Place& place = inside[k];
        const std::array<std::uint32_t, 8>& n = used[place.cell].nodes;
        const glm::vec3& w = place.within;
        const Four low = mix(mix(at(n[0]), at(n[1]), w.x), mix(at(n[2]), at(n[3]), w.x), w.y);
        const Four high = mix(mix(at(n[4]), at(n[5]), w.x), mix(at(n[6]), at(n[7]), w.x), w.y);
        const Four out = mix(low, high, w.z);
        __builtin_memcpy(&atVertices[k], &out, sizeof out);
    }
}

}  // namespace reflection
