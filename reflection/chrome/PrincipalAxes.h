#pragma once

#include <array>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <vector>

namespace reflection {

/// A box around triangles along the axes in which their area spreads most and least.
struct PrincipalBox {
    glm::dmat3 axes{1};        ///< columns, orthonormal, right-handed
    glm::dvec3 middle{0};      ///< of the box, in the triangles' frame
    glm::dvec3 halfExtent{0};  ///< along the axes
};

/// Axes of the area-weighted covariance of the triangles (eigenvectors by Jacobi's rotations). Without area
/// or triangles: the frame's own axes. Deterministic.
PrincipalBox principalBox(const std::vector<std::array<glm::dvec3, 3>>& triangles);

}  // namespace reflection
