#include "reflection/chrome/CellTree.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace reflection {

namespace {

/// Times that an axis can be halved: corners then still have exact whole numbers of 21 bits.
constexpr int mostHalvings = 20;

/// Sides shorter than this share of the longest are not cut yet.
constexpr float shortSide = 0.7f;

using Key = std::array<std::uint32_t, 3>;

std::uint64_t packed(const Key& k) {
    return (std::uint64_t{k[2]} << 42) | (std::uint64_t{k[1]} << 21) | k[0];
}

}  // namespace

/// The lattice and what has been made of it.
struct CellTree::Builder {
    CellTree& tree;
    std::span<const glm::vec3> positions;
    glm::vec3 low{0}, extent{0};
    std::vector<std::array<bool, 3>> cut;      ///< for each level, the axes along which its cells are cut
    std::vector<std::array<int, 3>> halvings;  ///< for each level, of each axis, before it
    std::unordered_map<std::uint64_t, std::uint32_t> known;
    std::vector<Key> corners;  ///< of each cell, its low one

    std::uint32_t node(const Key& k) {
        const auto [at, added] = known.try_emplace(packed(k), static_cast<std::uint32_t>(tree.points.size()));
        if (added) {
            glm::vec3 p;
            for (int a = 0; a < 3; ++a)
                p[a] = low[a] + extent[a] * (static_cast<float>(k[static_cast<std::size_t>(a)]) /
                                             static_cast<float>(1U << mostHalvings));
            tree.points.push_back(p);
        }
        return at->second;
    }

    void levels() {
        std::array<int, 3> done{};
        glm::vec3 side = extent;
        for (int level = 0; level < 3 * mostHalvings; ++level) {
            tree.sides.push_back(side);
            halvings.push_back(done);
            const float longest = std::max({side.x, side.y, side.z});
            std::array<bool, 3> here{};
            for (int a = 0; a < 3; ++a) {
                const auto i = static_cast<std::size_t>(a);
                here[i] = side[a] > 0 && side[a] >= shortSide * longest && done[i] < mostHalvings;
                if (here[i]) side[a] *= 0.5f, ++done[i];
            }
            cut.push_back(here);
            if (!here[0] && !here[1] && !here[2]) break;
        }
    }

    Cell cell(const Key& corner, int level, std::uint32_t first, std::uint32_t last) {
        Cell c;
        c.level = static_cast<std::uint8_t>(level);
        c.first = first, c.last = last;
        for (std::uint32_t k = 0; k < 8; ++k) {
            Key at = corner;
            for (std::uint32_t a = 0; a < 3; ++a)
                if (((k >> a) & 1) != 0 && extent[static_cast<int>(a)] > 0)
                    at[a] += 1U << (mostHalvings - halvings[static_cast<std::size_t>(level)][a]);
            c.nodes[k] = node(at);
        }
        c.low = tree.points[c.nodes[0]];
        return c;
    }

    void cutCells(std::uint32_t fewest) {
        std::vector<std::uint32_t> sorted;
        for (std::size_t k = 0; k < tree.all.size(); ++k) {
            const Cell c = tree.all[k];
            const auto level = static_cast<std::size_t>(c.level);
            const std::array<bool, 3>& along = cut[level];
            if (c.vertices() <= fewest || level + 1 >= tree.sides.size()) continue;
            const Key corner = corners[k];
            const glm::vec3 middle = c.low + 0.5f * tree.sides[level];
            const auto part = [&](std::uint32_t v) {
                std::uint32_t p = 0;
                for (int a = 0; a < 3; ++a)
                    if (along[static_cast<std::size_t>(a)] && positions[v][a] >= middle[a]) p |= 1U << a;
                return p;
            };
            std::array<std::uint32_t, 9> begin{};
            for (std::uint32_t v = c.first; v < c.last; ++v) ++begin[part(tree.vertices[v]) + 1];
            for (std::size_t p = 1; p < 9; ++p) begin[p] += begin[p - 1];
            sorted.resize(c.vertices());
            std::array<std::uint32_t, 9> next = begin;
            for (std::uint32_t v = c.first; v < c.last; ++v)
                sorted[next[part(tree.vertices[v])]++] = tree.vertices[v];
            std::copy(sorted.begin(), sorted.end(), tree.vertices.begin() + c.first);
            tree.all[k].children = static_cast<std::uint32_t>(tree.all.size());
            for (std::uint32_t p = 0; p < 8; ++p) {
                if (begin[p] == begin[p + 1]) continue;
                Key at = corner;
                for (std::uint32_t a = 0; a < 3; ++a)
                    if (((p >> a) & 1) != 0) at[a] += 1U << (mostHalvings - halvings[level + 1][a]);
                tree.all.push_back(cell(at, c.level + 1, c.first + begin[p], c.first + begin[p + 1]));
                corners.push_back(at);
                ++tree.all[k].count;
            }
        }
    }
};

CellTree::CellTree(std::span<const glm::vec3> positions, std::uint32_t fewest) {
    Builder builder{*this, positions, {}, {}, {}, {}, {}, {}};
    glm::vec3 low(INFINITY), high(-INFINITY);
    for (std::uint32_t k = 0; k < positions.size(); ++k) {
        const glm::vec3& p = positions[k];
        if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) continue;
        vertices.push_back(k);
        for (int a = 0; a < 3; ++a) low[a] = std::min(low[a], p[a]), high[a] = std::max(high[a], p[a]);
    }
    if (vertices.empty()) return;
    builder.low = low;
    builder.extent = high - low;
    builder.levels();
    all.push_back(builder.cell({}, 0, 0, static_cast<std::uint32_t>(vertices.size())));
    builder.corners.push_back({});
    builder.cutCells(fewest);
    for (std::size_t a = 0; a < 3; ++a) {
        ordered[a].reserve(vertices.size() + padding);
        for (const std::uint32_t v : vertices) ordered[a].push_back(positions[v][static_cast<int>(a)]);
        ordered[a].resize(vertices.size() + padding, 0.f);
    }
    for (Cell& c : all) {
        float farthest = -1;
        for (std::uint32_t v = c.first; v < c.last; ++v) {
            const glm::vec3 p(ordered[0][v], ordered[1][v], ordered[2][v]);
            float far = 0;
            // What interpolation along an axis leaves out grows as this.
            for (int a = 0; a < 3; ++a) {
                const float s = sides[c.level][a];
                const float x = s > 0 ? (p[a] - c.low[a]) / s : 0;
                far += x * (1 - x) * s;
            }
            if (far > farthest) farthest = far, c.probe = v;
        }
    }
}

}  // namespace reflection
