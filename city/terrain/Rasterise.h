#pragma once

#include <glm/mat4x4.hpp>

#include "city/geometry/Mesh.h"
#include "city/terrain/Heightfield.h"

namespace city {

/// How much of a cell a triangle must cover to raise it.
enum class Coverage {
    centre,  ///< the cell's centre lies under the triangle: what a top view with one sample a cell would show
    any,     ///< any overlap: no gap in thin walls, silhouettes up to one cell too wide
    whole,   ///< only cells that the mesh covers entirely at or above the height: safe as an occluder
};

/// Raises every cell to the highest point at which the mesh covers it, as an orthographic camera above would
/// see it. `transform` maps mesh to world. Vertical triangles cover nothing under `centre` and `whole`; under
/// `any` they raise the cells that they pass through.
///
/// The height is that of the surface at the cell's centre (`centre`), its highest point in the cell (`any`),
/// or the greatest height z such that the parts of the mesh above z cover the cell (`whole`). A triangle owns
/// its edges, so that no centre falls between two that share an edge. `whole` forgives gaps of less than 1e-6
/// of the cell's area: rounding along shared edges. Cells never sink; NaN cells count as empty. Triangles
/// with a corner that is not finite, and indices past the vertices, are left out. Cost: triangles + cells
/// touched; `centre` about 0.1 us a small triangle, `any` and `whole` a few times that.
void rasterise(const Mesh& mesh, const glm::mat4& transform, Coverage coverage, Heightfield& field);

}  // namespace city
