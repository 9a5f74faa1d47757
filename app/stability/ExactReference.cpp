#include "app/stability/ExactReference.h"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wpedantic"
#include <boost/multiprecision/cpp_int.hpp>
#pragma GCC diagnostic pop

#include <algorithm>
#include <cmath>
#include <limits>

namespace app::stability {

namespace {

using reflection::TraceStatus;
using Integer = boost::multiprecision::number<boost::multiprecision::cpp_int_backend<
    1536, 1536, boost::multiprecision::signed_magnitude, boost::multiprecision::unchecked, void>>;

constexpr float infinity = std::numeric_limits<float>::infinity();

/// In units of 2^-310, below the lowest bit of any float and of any border of the campaign's fields; products
/// of two floats' differences stay below 2^900.
constexpr int unitBits = 310;

Integer exact(double value) {
    int exponent = 0;
    const double fraction = std::frexp(value, &exponent);
    Integer result = static_cast<long long>(std::ldexp(fraction, 53));
    const int shift = exponent - 53 + unitBits;
    if (shift >= 0)
        result <<= shift;
    else
        result >>= -shift;
    return result;
}

/// Sign of (a1 - a0) p - (b1 - b0) q.
int sign(double a1, double a0, double p, double b1, double b0, double q) {
    const long double ap =
        (static_cast<long double>(a1) - static_cast<long double>(a0)) * static_cast<long double>(p);
    const long double bq =
        (static_cast<long double>(b1) - static_cast<long double>(b0)) * static_cast<long double>(q);
    const long double difference = ap - bq;
    // Two roundings a product and one of the difference, each of half an epsilon: 1.5 epsilon; 4 are allowed,
    // and a number far above where a double would lose bits.
    const long double bound =
        4 * std::numeric_limits<long double>::epsilon() * (std::abs(ap) + std::abs(bq)) + 1e-270L;
    if (difference > bound) return 1;
    if (difference < -bound) return -1;
    const Integer left = (exact(a1) - exact(a0)) * exact(p), right = (exact(b1) - exact(b0)) * exact(q);
    return left < right ? -1 : left > right ? 1 : 0;
}

bool isValid(const city::Ray& ray) {
    bool moves = false;
    for (int c = 0; c < 3; ++c) {
        if (!std::isfinite(ray.origin[c]) || !std::isfinite(ray.direction[c])) return false;
        moves = moves || ray.direction[c] != 0;
    }
    return moves;
}

/// Along one horizontal axis.
struct Axis {
    double origin = 0, direction = 0;  ///< of the ray
    int cells = 0;
    int cell = -1;

    bool inside() const { return cell >= 0 && cell < cells; }
    bool hasBorderAhead() const { return direction > 0 ? cell < cells : direction < 0 && cell >= 0; }
    int borderAhead() const { return direction > 0 ? cell + 1 : cell; }
    double sense() const { return direction > 0 ? 1 : -1; }
    double speed() const { return std::abs(direction); }
};

}  // namespace

ExactReference::Answer ExactReference::trace(const city::Ray& ray) const {
    Answer answer;
    if (!isValid(ray)) {
        answer.status = TraceStatus::invalid;
        return answer;
    }
    const double oz = static_cast<double>(ray.origin.z), dz = static_cast<double>(ray.direction.z);
    Axis axes[2];
    for (int a = 0; a < 2; ++a) {
        Axis& axis = axes[a];
        axis.origin = static_cast<double>(ray.origin[a]);
        axis.direction = static_cast<double>(ray.direction[a]);
        axis.cells = a == 0 ? field_.width() : field_.height();
        // Borders at or before the start; comparing doubles is exact.
        int low = 0, high = axis.cells + 1;
        while (low < high) {
            const int middle = (low + high) / 2;
            if (plane(a, middle) <= axis.origin)
                low = middle + 1;
            else
                high = middle;
        }
        axis.cell = low - 1;
        if (axis.cell == axis.cells && !(axis.direction < 0)) return answer;
        if (axis.cell < 0 && !(axis.direction > 0)) return answer;
    }
    /// Is the ray at or below h where it crosses the border?
    const auto atOrBelow = [&](int a, double border, double h) {
        return sign(border, axes[a].origin, axes[a].sense() * dz, h, oz, axes[a].speed()) <= 0;
    };
    const auto hit = [&](long double numerator, long double denominator) {
        // What rounds to a float that is not finite: from the largest float and half a step on.
        if (numerator >= denominator * (0x1p128L - 0x1p103L)) return answer;
        answer.status = TraceStatus::hit;
        answer.cell = {axes[0].cell, axes[1].cell};
        answer.numerator = numerator;
        answer.denominator = denominator;
        return answer;
    };

    int enteredBy = -1;  // axis; -1: starts here
    double entry = 0;    // border
    for (;;) {
        const bool inside = axes[0].inside() && axes[1].inside();
        const float column = inside ? field_.at(axes[0].cell, axes[1].cell) : -infinity;
        const double h = static_cast<double>(column);
        const bool solid = column > -infinity;  // not for a NaN
        if (solid) {
            const bool isIn = column == infinity ||
                              (enteredBy < 0 ? ray.origin.z <= column : atOrBelow(enteredBy, entry, h));
            if (isIn && enteredBy < 0) return hit(0, 1);
            if (isIn) {
                const Axis& axis = axes[enteredBy];
                return hit(std::abs(static_cast<long double>(entry) - static_cast<long double>(axis.origin)),
                           static_cast<long double>(axis.speed()));
            }
        }
        int leavesBy = -1;
        double exit = 0;
        for (int a = 0; a < 2; ++a) {
            if (!axes[a].hasBorderAhead()) continue;
            const double border = plane(a, axes[a].borderAhead());
            // x first where both are crossed at once.
            if (leavesBy == 0 && sign(border, axes[1].origin, axes[1].sense() * axes[0].speed(), exit,
                                      axes[0].origin, axes[0].sense() * axes[1].speed()) >= 0)
                continue;
            leavesBy = a;
            exit = border;
        }
        if (solid && dz < 0 && (leavesBy < 0 || atOrBelow(leavesBy, exit, h)))
            return hit(static_cast<long double>(oz) - static_cast<long double>(h),
                       -static_cast<long double>(dz));
        if (leavesBy < 0) return answer;
        Axis& axis = axes[leavesBy];
        axis.cell += axis.direction > 0 ? 1 : -1;
        if ((axis.cell < 0 && axis.direction < 0) || (axis.cell >= axis.cells && axis.direction > 0))
            return answer;
        enteredBy = leavesBy;
        entry = exit;
    }
}

double ExactReference::shareOfBound(float t, const Answer& answer) {
    const long double truth = answer.numerator / answer.denominator;
    const long double error = std::abs(static_cast<long double>(t) - truth);
    // The truth itself is rounded three times.
    const long double own = 2 * std::numeric_limits<long double>::epsilon() * std::abs(truth);
    const long double bound = (0x1p-24L + 0x1p-51L) * std::abs(truth) + 0x1p-150L;
    return static_cast<double>(std::max(0.0L, error - own) / bound);
}

double ExactReference::depthOfPassage(const city::Ray& ray, const Answer& answer) const {
    if (answer.status != TraceStatus::hit) return 0;
    const long double enters = answer.numerator / answer.denominator;
    long double leaves = std::numeric_limits<long double>::infinity();
    for (int a = 0; a < 2; ++a) {
        const auto d = static_cast<long double>(ray.direction[a]);
        if (d == 0) continue;
        const auto border = static_cast<long double>(plane(a, answer.cell[a] + (d > 0 ? 1 : 0)));
        leaves = std::min(leaves, (border - static_cast<long double>(ray.origin[a])) / d);
    }
    const auto top = static_cast<long double>(field_.at(answer.cell.x, answer.cell.y));
    if (ray.direction.z > 0)
        leaves = std::min(leaves, (top - static_cast<long double>(ray.origin.z)) /
                                      static_cast<long double>(ray.direction.z));
    if (!std::isfinite(leaves)) leaves = enters + 1;  // straight down: the column has no bottom
    const long double middle = 0.5L * (enters + leaves);
    long double depth = std::numeric_limits<long double>::infinity();
    for (int a = 0; a < 2; ++a) {
        const long double at =
            static_cast<long double>(ray.origin[a]) + middle * static_cast<long double>(ray.direction[a]);
        depth = std::min({depth, at - static_cast<long double>(plane(a, answer.cell[a])),
                          static_cast<long double>(plane(a, answer.cell[a] + 1)) - at});
    }
    const long double z =
        static_cast<long double>(ray.origin.z) + middle * static_cast<long double>(ray.direction.z);
    return static_cast<double>(std::max(0.0L, std::min(depth, top - z)));
}

}  // namespace app::stability
