#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

namespace reflection {

// What virtual meshes of both bends do with their triangles.

using VirtualTriangle = std::array<std::uint32_t, 3>;

/// In place of an edge's middle: it has none.
inline constexpr std::uint32_t straightEdge = ~std::uint32_t{0};

/// After the last halving: how far from the middle, in edge lengths, an edge's middle may lie. Where an image
/// runs into the reflector's outline it moves as a root, and the middle lies 0.21 off; where it jumps, 0.5.
inline constexpr double tornShare = 0.35;

inline std::uint64_t edgeKey(std::uint32_t a, std::uint32_t b) {
    return a < b ? (static_cast<std::uint64_t>(a) << 32) | b : (static_cast<std::uint64_t>(b) << 32) | a;
}

/// Chord between the directions to two points, which is their angle where that is small.
double apartOf(const glm::vec3& a, const glm::vec3& b);

/// Angle between a direction and the nearest one of the arc that two points span.
double angleToArc(const glm::dvec3& towards, const glm::dvec3& a, const glm::dvec3& b);

/// Triangles after their halved edges were cut. `middle[k]`: of the edge from corner k to the next, or
/// `straightEdge`.
void cutTriangle(const VirtualTriangle& t, const VirtualTriangle& middle, std::vector<VirtualTriangle>& out);

}  // namespace reflection
