#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>

#include "city/geometry/Mesh.h"

namespace city {

/// Plain solids that generated buildings and furniture are made of. All outsides face outwards; metres.
/// Texture coordinates come in metres divided by `repeat` unless said otherwise.

/// Unit right-hand normal of the direction a -> b: the outside of a counter-clockwise ring's side.
glm::vec2 outward(glm::vec2 a, glm::vec2 b);

/// Vertical wall over a -> b from z0 to z1, seen from its right-hand side; texture (0,0)-(uRepeats,
/// vRepeats).
void addWall(Mesh& mesh, glm::vec2 a, glm::vec2 b, float z0, float z1, std::uint32_t material, float uRepeats,
             float vRepeats);

/// Flat quad a, b, c, d (counter-clockwise from the front) with the normal of its corners, texture (0,0)-(u,
/// v).
void addPanel(Mesh& mesh, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::vec3& d,
              std::uint32_t material, float u = 1, float v = 1);

/// Flat triangle with world-metre texture coordinates along its own plane.
void addFacet(Mesh& mesh, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, std::uint32_t material,
              float repeat = 1);

/// Convex counter-clockwise ring as an upward (or downward) face at height z, texture = world x, y / repeat.
void addDeck(Mesh& mesh, std::span<const glm::vec2> ring, float z, std::uint32_t material, float repeat = 1,
             bool up = true);

/// Convex counter-clockwise ring from z0 to z1: sides and top, without a floor.
void addPrism(Mesh& mesh, std::span<const glm::vec2> ring, float z0, float z1, std::uint32_t side,
              std::uint32_t top, float repeat = 1);

/// Which faces of a box to make.
enum BoxFaces : unsigned {
    boxFront = 1,
    boxRight = 2,
    boxBack = 4,
    boxLeft = 8,
    boxTop = 16,
    boxBottom = 32,
    boxAll = 63
};

/// Box on the frame (origin, along, outward = right-hand side of `along`, up): s runs along, t outwards, z
/// up. Front is the face at t1. `along` has unit length.
struct BoxExtent {
    float s0, s1, t0, t1, z0, z1;
};
void addBox(Mesh& mesh, glm::vec2 origin, glm::vec2 along, const BoxExtent& extent, std::uint32_t material,
            unsigned faces = boxAll & ~boxBottom, float repeat = 1);

/// Cone frustum from p0 to p1 with smooth sides, open ends; radius 0 makes a point (one triangle a side).
void addTube(Mesh& mesh, const glm::vec3& p0, const glm::vec3& p1, float radius0, float radius1, int sides,
             std::uint32_t material, float repeat = 1);

/// Surface of revolution about the vertical through `foot`: profile points are (radius, z above the foot),
/// from bottom to top.
void addLathe(Mesh& mesh, const glm::vec3& foot, std::span<const glm::vec2> profile, int sides,
              std::uint32_t material, float repeat = 1);

}  // namespace city
