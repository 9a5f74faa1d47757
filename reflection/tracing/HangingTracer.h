#pragma once

#include <span>

#include "city/terrain/Overhang.h"
#include "reflection/tracing/GridTracer.h"

namespace reflection {

/// First entry of a ray into columns that hang (city::Overhang): solid from an underside up to a top. Two
/// heightfields are traced, one of them upside down: a ray is inside where it is in a column of both, and the
/// two take turns in saying where it enters next what it is not in yet.
///
/// A column is entered, at the ray's start too, where z is between underside and top, both included. Which
/// columns are passed is decided as GridTracer decides it; heights at their borders are compared in floats,
/// so that a ray within a rounding error (some 1e-6 of the height, of t) of an edge may be told as on either
/// side.
class HangingTracer {
  public:
    /// Copies what it needs. Cost and exceptions: those of two GridTracers.
    explicit HangingTracer(const city::Overhang& hanging);

    /// Entries with t > tMax count as misses. Cost: as GridTracer's for rays that meet none; three times that
    /// for those that do.
    TraceResult trace(const city::Ray& ray, float tMax) const;

    /// Lowers t[k] to where ray k enters a hanging column before that. As GridTracer::traceFan.
    void lower(glm::vec3 origin, std::span<const float> dx, std::span<const float> dy,
               std::span<const float> dz, std::span<float> t) const;

  private:
    city::Overhang hanging_;
    GridTracer undersides_;  ///< upside down
    GridTracer tops_;
};

}  // namespace reflection
