#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <vector>

namespace reflection {

/// A regular grid of near-cubic cells around a mesh of which only the cells that hold a vertex are kept.
/// Values at the grid's nodes (a virtual vertex and the length of its path) give those of the mesh's vertices
/// by trilinear interpolation, so that searches follow what the reflection needs and not the mesh's vertex
/// count. Frame: the mesh's own. Immutable. Source: Estalella et al. 2005, section 5.
class BoundingGrid {
  public:
    struct Cell {
        std::array<std::uint32_t, 8> nodes;  ///< x fastest, then y, then z
    };
    struct Place {
        std::uint32_t cell;
        glm::vec3 within;  ///< 0 .. 1 along each axis of the cell
    };

    /// The finest grid with at most so many nodes (never fewer than the eight of one cell, for any vertex at
    /// all). Positions that are not finite are placed in the first cell's corner. Cost: about twenty passes
    /// over the vertices.
    BoundingGrid(std::span<const glm::vec3> positions, std::size_t mostNodes);

    std::span<const glm::vec3> nodes() const { return points; }
    std::span<const Cell> cells() const { return used; }
    std::span<const Place> places() const { return inside; }  ///< one for each vertex
    float cellSize() const { return size; }  ///< metres; cells are cubes of at most this side

    /// Trilinear interpolation of vec4 values at the nodes to all vertices. Cost: about 3 ns a vertex.
    void interpolate(std::span<const glm::vec4> atNodes, std::span<glm::vec4> atVertices) const;

  private:
    std::vector<glm::vec3> points;
    std::vector<Cell> used;
    std::vector<Place> inside;
    float size = 0;
};

}  // namespace reflection
