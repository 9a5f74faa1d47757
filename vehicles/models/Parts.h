#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "vehicles/models/VehicleModel.h"

namespace vehicles {

/// Adds the surface that a profile sweeps round the y axis. Profile points are (y, radius); it runs from the
/// hub on the +y side outwards and back on the -y side, the outside on its right. Corners sharper than about
/// 40 degrees stay hard.
void addRevolved(city::Mesh& mesh, const std::vector<glm::vec2>& profile, int segments, Surface surface);

/// Adds a box with rounded edges (a superellipsoid; the larger the exponent, the boxier; 2 is an ellipsoid),
/// turned by `turn`.
void addRounded(city::Mesh& mesh, const glm::vec3& centre, const glm::vec3& half, float exponent,
                int segments, Surface surface, const glm::mat3& turn = glm::mat3(1));

/// Adds a box with flat faces.
void addBox(city::Mesh& mesh, const glm::vec3& low, const glm::vec3& high, Surface surface);

/// Adds a flat quadrilateral, counter-clockwise from its front.
void addPlate(city::Mesh& mesh, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c,
              const glm::vec3& d, Surface surface);

/// Adds a round bar between two points.
void addBar(city::Mesh& mesh, const glm::vec3& from, const glm::vec3& to, float radius, int segments,
            Surface surface);

/// Adds the mirror image across y = 0 of everything in the mesh.
void addMirrored(city::Mesh& mesh);

}  // namespace vehicles
