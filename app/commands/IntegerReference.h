#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <optional>
#include <vector>

#include "city/geometry/Ray.h"
#include "city/terrain/Heightfield.h"
#include "reflection/tracing/GridTracer.h"

namespace app {

/// GridTracer's rules in 64- and 128-bit integers, cell by cell: exact, and fast enough for 10^7 rays. Needs
/// borders on multiples of 2^-12 m within 2^14 m, heights that are multiples of 2^-44 m, rays that start
/// inside the field at multiples of 2^-12 m, and directions of multiples of 2^-24 with |component| <= 1.
class IntegerReference {
  public:
    /// Nothing when the field does not meet the needs.
    static std::optional<IntegerReference> of(const city::Heightfield& field);

    /// Is `result` what the rules say, its t within (2^-24 + 2^-51) |t*| + 2^-150 of the exact parameter t*?
    bool confirms(const city::Ray& ray, const reflection::TraceResult& result) const;

  private:
    IntegerReference() = default;

    int width_ = 0;
    int height_ = 0;
    std::int64_t cell_ = 0;  ///< units of 2^-12 m, as are the corners
    std::int64_t cornerX_ = 0;
    std::int64_t cornerY_ = 0;
    std::vector<std::int64_t> columns_;  ///< units of 2^-44 m
};

}  // namespace app
