#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <unordered_map>
#include <vector>

#include "reflection/gl/ChromeSearch.h"
#include "reflection/gl/VertexArray.h"

namespace reflection {

/// Meshes whose image in a piece of a reflector the GPU searches for and draws without anybody reading it
/// back: VirtualMesh and gl::ChromeMesh in one.
///
/// All vertices are searched for, none interpolated on a grid: on a graphics card a search costs less than
/// what a grid would take in passes and in error. As nothing is read back, edges cannot be halved by how
/// their images bend; they are halved once, by what bends them: the angle under which the reflector's centre
/// sees them. An edge of angle a has an image of about a / 2 radii of the reflector's own image, which bends
/// about as its outline does, and so lies a^2 / 32 of that radius off its chord: `longestEdge` keeps that
/// below a 3,000th, and below a 300th towards the outline where images bend ten times as much.
///
/// Needs a current GL 4.5 context in every call and at destruction.
class ChromeSearchMesh {
  public:
    static constexpr double longestEdge = 0.1;  ///< radians seen from the map's centre
    static constexpr int mostCuts = 20;         ///< of a triangle into two, in a row

    /// The map's copy is made here. `floatsPerVertex`: of the host's own attributes, at most 4.
    ChromeSearchMesh(const ReflectorMap& map, int floatsPerVertex);

    /// Adds a mesh: positions in the reflector's frame, metres; the host's floats for each vertex (those of
    /// middles are the means of their ends'). For what does not move: each call makes the buffers anew.
    void add(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices,
             std::span<const float> ofVertices);

    /// Searches. Frame of the eye: the reflector's.
    void update(ChromeSearch& search, const glm::dvec3& eye);
    /// Draws with the program in use: location 0 vec3 from the eye, 1 the host's floats, 2 the status as an
    /// unsigned integer. Triangles are all there: leave out fragments between hidden vertices only.
    void draw() const;

    std::size_t vertexCount() const { return positions_.size() / 3; }
    std::size_t triangleCount() const { return indices_.size() / 3; }

  private:
    void cut(const std::array<std::uint32_t, 3>& triangle, int depth);
    std::uint32_t middleOf(std::uint32_t a, std::uint32_t b);
    double angleOf(std::uint32_t a, std::uint32_t b) const;
    void makeBuffers();

    ChromeMapBuffer map_;
    std::size_t floats_;
    std::vector<float> positions_;  ///< relative to the map's centre
    std::vector<float> values_;
    std::vector<std::uint32_t> indices_;
    std::unordered_map<std::uint64_t, std::uint32_t> middles_;  ///< by their ends
    gl::Buffer given_, host_, drawn_, results_;
    gl::VertexArray array_;
    bool changed_ = false;
};

}  // namespace reflection
