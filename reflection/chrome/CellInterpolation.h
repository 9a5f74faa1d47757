#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "reflection/chrome/CellTree.h"
#include "reflection/chrome/PathPerturbation.h"
#include "reflection/chrome/VirtualVertex.h"

namespace reflection {

/// A cell whose vertices' images follow from those at its nodes.
struct SmoothCell {
    std::uint32_t cell = 0;
    /// Of its vertices; invalid: the reflector's outline crosses it, and the cosine tells hidden vertices.
    ReflectionStatus status = ReflectionStatus::found;
    float doubt = 0;        ///< cosines nearer to zero than this do not tell
    bool straight = false;  ///< slopes are left out: of what is not seen, or beyond a crease
};

/// Between the nodes of a cell values follow cubics along its edges, blended linearly across (the 32 numbers
/// of an "Adini" element: a value and three slopes a node): exact for cubics, continuous between cells of one
/// size, with an error of fourth order in the cell's size. Vertices whose status the cosine does not tell are
/// added to `doubtful` (as places in tree.order()).
///
/// Cost: about 3 ns a vertex, sixteen at a time where the processor has AVX-512.
void interpolateCells(const CellTree& tree, std::span<const PathImage> atNodes,
                      std::span<const SmoothCell> cells, std::span<VirtualVertex> image,
                      std::vector<std::uint32_t>& doubtful);

/// One place in a cell: as above, slowly.
glm::vec4 interpolateIn(const CellTree& tree, std::span<const PathImage> atNodes, const CellTree::Cell& cell,
                        const glm::vec3& place);

}  // namespace reflection
