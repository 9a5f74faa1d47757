#pragma once

#include <glm/vec3.hpp>

#include "app/mirrors/MirrorWorld.h"
#include "city/geometry/Mesh.h"

namespace app {

/// Shapes of the mirror scenes, made of exactly as many triangles as they say.

/// columns * rows rectangles from `origin` along u and v, alternating two colours: 2 columns rows triangles.
/// The front is that from which u turns to v counter-clockwise.
LitMesh litPanel(const glm::vec3& origin, const glm::vec3& u, const glm::vec3& v, int columns, int rows,
                 const glm::vec3& colour, const glm::vec3& second);
/// 12 triangles.
LitMesh litBox(const glm::vec3& low, const glm::vec3& high, const glm::vec3& colour);
/// Poles along z: 2 slices (stacks - 1) triangles.
LitMesh litBall(const glm::vec3& centre, float radius, int slices, int stacks, const glm::vec3& colour);
/// An upright round pillar without its ends: 2 slices triangles.
LitMesh litPillar(const glm::vec3& foot, float radius, float height, int slices, const glm::vec3& colour);

/// Light from above and from one side, baked into the corners: Lambert's law over a sky of even light.
void bakeLight(LitMesh& mesh);

/// The same triangles cut until no edge is longer than `longest`: for projections that bend straight lines.
LitMesh subdivided(const LitMesh& mesh, float longest);

/// Its triangles and normals without their light.
city::Mesh withoutLight(const LitMesh& mesh);

}  // namespace app
