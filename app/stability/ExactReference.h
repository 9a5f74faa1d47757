#pragma once

#include <cstdint>
#include <glm/vec2.hpp>

#include "city/geometry/Ray.h"
#include "city/terrain/Heightfield.h"
#include "reflection/tracing/GridTracer.h"

namespace app::stability {

/// GridTracer's rules for any valid ray, cell by cell, without rounding error and without a line of the
/// tracer's: every decision is made in long double where its rounding cannot matter, else in integers of 1536
/// bits. About a microsecond a ray: fast enough for 10^8.
///
/// The plain around the grid is walked like the grid: cell -1 lies before its first border, cell n behind its
/// last.
class ExactReference {
  public:
    struct Answer {
        reflection::TraceStatus status = reflection::TraceStatus::miss;
        glm::ivec2 cell{-1};
        /// The exact parameter of the entry is numerator / denominator (> 0), rounded in the last bits of the
        /// long doubles.
        long double numerator = 0;
        long double denominator = 1;
    };

    /// Keeps a reference to the field.
    explicit ExactReference(const city::Heightfield& field) : field_(field) {}

    /// An entry beyond the largest float is a miss, as for the tracer.
    Answer trace(const city::Ray& ray) const;

    /// Error of a hit's t as a share of the bound derived in ExactWalk.h, (2^-24 + 2^-51) |t*| + 2^-150.
    static double shareOfBound(float t, const Answer& answer);

    /// Metres by which the ray runs deep within the column that it hits: the least distance of the middle of
    /// its way through it from the column's walls and top. 0 where it touches a wall, an edge or a top. In
    /// long double: for telling touches from passages, not for deciding.
    double depthOfPassage(const city::Ray& ray, const Answer& answer) const;

  private:
    double plane(int axis, int k) const {
        return field_.origin()[axis] + static_cast<double>(k) * static_cast<double>(field_.cellSize());
    }

    const city::Heightfield& field_;
};

}  // namespace app::stability
