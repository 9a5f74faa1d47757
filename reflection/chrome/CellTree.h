#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace reflection {

/// A mesh's vertices in boxes within boxes: each box that holds enough of them is cut in the middle of its
/// long sides, so that boxes become near-cubic and finer, and only those that hold a vertex are kept. Corners
/// of boxes (nodes) are shared by all boxes of all sizes that meet there. Frame: the mesh's own. Immutable.
/// The hierarchy that Estalella et al. 2005 wish for in section 8.
class CellTree {
  public:
    struct Cell {
        std::array<std::uint32_t, 8> nodes{};  ///< x fastest, then y, then z
        std::uint32_t first = 0, last = 0;     ///< its vertices' places in order()
        std::uint32_t children = 0;            ///< the first of them; they follow each other
        std::uint8_t count = 0;                ///< of children
        std::uint8_t level = 0;
        std::uint32_t probe = 0;  ///< place in order() of the vertex that is farthest from the nodes
        glm::vec3 low{0};
        std::uint32_t vertices() const { return last - first; }
    };

    /// Positions that are not finite are in no cell. Cells of at most `fewest` vertices are not cut. Cost:
    /// about a pass over the vertices a level, once.
    CellTree(std::span<const glm::vec3> positions, std::uint32_t fewest);

    /// The first is the whole; empty: no vertex.
    std::span<const Cell> cells() const { return all; }
    std::span<const glm::vec3> nodes() const { return points; }
    /// Of a level's cells; 0 along axes in which the mesh has no extent: there both ends are one node.
    const glm::vec3& side(int level) const { return sides[static_cast<std::size_t>(level)]; }
    /// The vertices, cell by cell, and their positions (each array padded by `padding` numbers).
    std::span<const std::uint32_t> order() const { return vertices; }
    const float* along(int axis) const { return ordered[static_cast<std::size_t>(axis)].data(); }

    static constexpr std::size_t padding = 16;

  private:
    struct Builder;

    std::vector<Cell> all;
    std::vector<glm::vec3> points;
    std::vector<glm::vec3> sides;
    std::vector<std::uint32_t> vertices;
    std::array<std::vector<float>, 3> ordered;
};

}  // namespace reflection
