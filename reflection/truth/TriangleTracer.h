#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <span>

#include "city/geometry/Mesh.h"

namespace reflection {

/// Exact rays against triangles (Embree 3, robust mode): the rival of the local maps and the source of truth.
/// Build once: add meshes, then `commit`.
class TriangleTracer {
  public:
    TriangleTracer();
    ~TriangleTracer();

    /// Adds a mesh's triangles in world coordinates; copies them. Empty meshes are skipped.
    void add(const city::Mesh& mesh, const glm::mat4& worldFromMesh = glm::mat4(1));
    void commit();

    /// Ray parameter of the first hit for each direction from one origin, +infinity for none; in packets of
    /// sixteen.
    void traceFan(const glm::vec3& origin, std::span<const float> dx, std::span<const float> dy,
                  std::span<const float> dz, std::span<float> t) const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace reflection
