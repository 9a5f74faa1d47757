#pragma once

namespace reflection {

/// Sign (-1, 0, +1) of (a1 - a0) * p - (b1 - b0) * q, without rounding error.
/// Holds for |a|, |b| <= 2^120 whose lowest set bit is not below 2^-700, and any finite float p, q (as
/// doubles): then nothing overflows or underflows. Cost: a few multiplications; about 40 operations when the
/// two products are equal to within 2^-50 of their size. Source: Shewchuk, "Adaptive precision floating-point
/// arithmetic and fast robust geometric predicates", 1997.
int signOfDifference(double a1, double a0, double p, double b1, double b0, double q);

}  // namespace reflection
