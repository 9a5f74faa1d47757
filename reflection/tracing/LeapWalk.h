#pragma once

#include <span>

#include "city/geometry/Ray.h"
#include "reflection/tracing/ExactWalk.h"
#include "reflection/tracing/TracedGrid.h"

namespace reflection {

/// The leaping walk: float arithmetic that knows how wrong it may be.
///
/// It follows a ray in cells passed since the start, mirrored so that the ray goes towards +a and +b:
///     a(t) = fa + t |dx|,  b(t) = fb + t |dy|,  z(t) = oz + t dz cellSize,      t in cells (metres /
///     cellSize),
/// with fa, fb in [0, 1] the start within its (exactly known) cell. Where the ray is above the level of the
/// cell's open rectangle it leaps to the rectangle's border, or to where it sinks to that level; else it
/// looks at the cell itself.
///
/// Errors, with u = 2^-24 for each rounded float operation: fa, fb carry u / 2 (rounded once from double). A
/// border at integer n is reached at t = (n - fa) / |dx| = (n - fa) * inv: |error of t| <= u (3 t + inv).
/// From that,
///     |error of b| <= |dy| u (5 t + inv) + 1.5 u  and  |error of z| <= |dz| u (5 t + inv) + u (|oz| + |z|).
/// The walk allows, with e = 2^-20 = 16 u (three times what is needed) and invMax the larger of 1 / |dx|, 1 /
/// |dy|:
///     lateral(t) = e (t + invMax) max(|dx|, |dy|) + 2 e                 cells
///     vertical(t) = e (t + invMax) |dz| + e (|oz| + largest |column|)   metres
/// Whenever a border is nearer than `lateral`, or a height nearer than `vertical`, the walk cannot tell which
/// side is right, gives up, and exactWalk decides: about one ray in a thousand. So its answers are the exact
/// ones, on every processor, and every way of walking (single, four, eight or sixteen rays at a time) has the
/// same answers. A direction component below 2^-30 of the other horizontal one counts as never crossing a
/// border: over a leap of 64 cells it drifts by 6e-8 cells, less than `lateral`, so that no crossing goes
/// unnoticed.
constexpr float leapError = 0x1p-20f;
constexpr float negligibleSlope = 0x1p-30f;
/// Horizontal direction lengths between which no product of the walk can overflow or lose bits.
constexpr float leapSlowest = 0x1p-40f;
constexpr float leapFastest = 0x1p40f;
constexpr float leapHighest = 0x1p60f;  ///< of |oz| and |dz|

/// Walks any ray, valid or not. Cost: about 20 ns in a street.
TraceResult leapWalk(const TracedGrid& grid, const city::Ray& ray, float tMax);

/// Is every component finite and the direction not zero?
bool validRay(const city::Ray& ray);

/// The exact walk's t for any ray: NaN for an invalid one, +infinity on a miss.
float exactAnswer(const TracedGrid& grid, const city::Ray& ray);

/// Rays of one origin, several at a time, with the widest vectors that the processor has. The spans have one
/// length.
void leapFan(const TracedGrid& grid, const glm::vec3& origin, std::span<const float> dx,
             std::span<const float> dy, std::span<const float> dz, std::span<float> t);

}  // namespace reflection
