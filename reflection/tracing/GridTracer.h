#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "city/geometry/Ray.h"
#include "city/terrain/Heightfield.h"

namespace reflection {

enum class TraceStatus : std::uint8_t {
    hit,      ///< t and cell are set
    miss,     ///< the ray leaves the grid or rises above every column
    invalid,  ///< a component of the ray is not finite, or the direction is zero
};

struct TraceResult {
    TraceStatus status = TraceStatus::miss;
    float t = 0;          ///< ray parameter of the entry into the solid; +infinity on a miss
    glm::ivec2 cell{-1};  ///< the column entered
};

/// First entry of a ray into the solid columns of a heightfield (Meyer & Loscos 2003, section 4.2; Amanatides & Woo
/// 1987; Musgrave 1988). A ray that starts inside a column hits it at t = 0.
class GridTracer {
  public:
    explicit GridTracer(const city::Heightfield& field);

    TraceResult trace(const city::Ray& ray) const;

    /// Many rays from one origin: what a local map needs. Direction k is (dx[k], dy[k], dz[k]); t[k] becomes its ray
    /// parameter, +infinity on a miss and NaN for an invalid ray. All spans have one length. Agrees with `trace` bit for bit.
    void traceFan(glm::vec3 origin, std::span<const float> dx, std::span<const float> dy, std::span<const float> dz,
                  std::span<float> t) const;
};

}  // namespace reflection
