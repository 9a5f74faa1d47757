#pragma once

#include "city/geometry/Ray.h"
#include "reflection/tracing/GridTracer.h"
#include "reflection/tracing/TracedGrid.h"

namespace reflection {

/// Through which face of a column a ray entered it.
enum class EntryFace : std::uint8_t { start, x, y, top };

/// The rules of GridTracer, decided without rounding error, cell by cell. For any ray that GridTracer calls
/// valid. This is what the leaping walks hand over to when their own arithmetic cannot decide. Cost: one
/// exact comparison a cell, about 10 ns each.
TraceResult exactWalk(const TracedGrid& grid, const city::Ray& ray, float tMax);

/// Ray parameter of the entry through `face` of cell (i, j): the one formula from which every t is made.
///
/// Bound. Let t* be the exact parameter, u = 2^-53. The numerator plane - origin is one rounded subtraction
/// of doubles (the plane is a double by definition, a height and an origin are floats): (1 + e1). The
/// quotient adds (1 + e2), |e| <= u; rounding to float adds (1 + e3), |e3| <= 2^-24, or an absolute 2^-150
/// where t is subnormal. In all
///     |t - t*| <= (2^-24 + 2.01 * 2^-53) |t*| + 2^-150 < 0.5000001 * 2^-23 |t*| + 2^-150.
float entryParameter(const TracedGrid& grid, const city::Ray& ray, EntryFace face, int i, int j);

}  // namespace reflection
