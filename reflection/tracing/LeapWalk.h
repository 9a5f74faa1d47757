#pragma once

#include <span>

#include "city/geometry/Ray.h"
#include "reflection/tracing/ExactWalk.h"
#include "reflection/tracing/TracedGrid.h"

namespace reflection {

/// The leaping walks: quick arithmetic that knows how wrong it may be.
///
/// Where a ray is above the level of the open rectangle of its cell it leaps to the rectangle's border, or to
/// where it sinks to that level; else it looks at the cell's own column. Parameters are computed anew from
/// each border, so that errors do not add up on the way. Whenever a border is nearer than `lateral`, or a
/// height nearer than `vertical`, a walk cannot tell which side is right, gives up, and exactWalk decides. So
/// the answers are the exact ones, on every processor, and every way of walking has the same answers.
///
/// leapWalk follows one ray in doubles, x and y side by side in one vector. With u = 2^-53, W and H the
/// grid's size in cells and F its borders' largest distance from the world's origin, in cells:
///   A coordinate in cells (3 roundings) and a border's (1, of the plane) are within b = 2^-50 (F + W + H) of
///   the true ones, with room for eight times that. A border of an axis of speed s (cells a unit of t) is
///   therefore crossed within b / s of the computed t; then the other axis, of speed s', is within b + b s' /
///   s, and the height, of r levels a unit of t, within b r / s. Rays are taken only where (s + s' + |r|) b <
///   2^-19 s for the slower axis s (the other one if it does not move at all; it is then never crossed). So
///       lateral = 2^-18 cells,  and 2^-19 levels of the height.
///   Rounding adds 2^-50 of the levels travelled, at most 2^37, and the rectangles' levels are rounded up in
///   float: off by less than 2^-22 of the largest height. So
///       vertical = 2^-22 largest / step + 2^-8 levels.
///   About one ray in a hundred thousand is left to exactWalk.
///
/// leapFan follows rays in floats, in cells passed since the start, mirrored so that the ray goes towards +a
/// and +b:
///     a(t) = fa + t |dx|,  b(t) = fb + t |dy|,  z(t) = oz + t dz cellSize,      t in cells (metres /
///     cellSize),
/// with fa, fb in [0, 1] the start within its (exactly known) cell. With u = 2^-24 for each rounded
/// operation: fa, fb carry u / 2 (rounded once from double). A border at integer n is reached at t = (n - fa)
/// / |dx| = (n - fa) * inv: |error of t| <= u (3 t + inv). From that,
///     |error of b| <= |dy| u (5 t + inv) + 1.5 u  and  |error of z| <= |dz| u (5 t + inv) + u (|oz| + |z|).
/// The walk allows, with e = 2^-20 = 16 u (three times what is needed) and invMax the larger of 1 / |dx|, 1 /
/// |dy|:
///     lateral(t) = e (t + invMax) max(|dx|, |dy|) + 2 e                 cells
///     vertical(t) = e (t + invMax) |dz| + e (|oz| + largest |column|) + 2^-80   metres
/// The last term is for numbers so small that products lose their bits (2^-150 each, times t < 2^60): without
/// it a ray that sinks from 2^-149 m to a top at 0 would be told apart by nothing.
/// About one ray in a thousand is left to leapWalk. A direction component below 2^-30 of the other horizontal
/// one counts as never crossing a border: over a leap of 64 cells it drifts by 6e-8 cells, less than
/// `lateral`, so that no crossing goes unnoticed.
constexpr float leapError = 0x1p-20f;
constexpr float negligibleSlope = 0x1p-30f;
/// Horizontal direction lengths between which no product of the fan's walk can overflow or lose bits.
constexpr float leapSlowest = 0x1p-40f;
constexpr float leapFastest = 0x1p40f;
constexpr float leapHighest = 0x1p60f;   ///< of |oz| and |dz|
constexpr float leapTiny = 0x1p-80f;     ///< metres, of leapFan
constexpr double leapLateral = 0x1p-18;  ///< cells, of leapWalk
constexpr double leapFarthest =
    0x1p36;  ///< levels: starts farther from the grid's lowest column walk exactly

/// For a grid with its columns and rectangles.
LeapScale leapScale(const TracedGrid& grid);

/// Walks any ray, valid or not. Cost: about 25 ns in a street.
inline TraceResult leapWalk(const TracedGrid& grid, const city::Ray& ray, float tMax) {
    return grid.scale.walk(grid, ray, tMax);
}

/// What leapWalk leaves: the exact walk for any ray, `invalid` for those that are not valid.
TraceResult carefulWalk(const TracedGrid& grid, const city::Ray& ray, float tMax);

/// Rays of one origin, several at a time, with the widest vectors that the processor has. The spans have one
/// length.
void leapFan(const TracedGrid& grid, const glm::vec3& origin, std::span<const float> dx,
             std::span<const float> dy, std::span<const float> dz, std::span<float> t);

}  // namespace reflection
