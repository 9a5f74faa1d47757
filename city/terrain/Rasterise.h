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

/// Raises every cell to the highest point at which the mesh covers it, as an orthographic camera above would see it.
/// `transform` maps mesh to world. Vertical triangles cover nothing under `centre`. Cost: triangles + cells touched.
void rasterise(const Mesh& mesh, const glm::mat4& transform, Coverage coverage, Heightfield& field);

}  // namespace city
