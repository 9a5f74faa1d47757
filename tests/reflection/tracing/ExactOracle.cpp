#include "tests/reflection/tracing/ExactOracle.h"

#include <algorithm>
#include <cmath>

namespace reflection {

namespace {

using Integer = ExactOracle::Integer;

/// All coordinates are integers in units of 2^-310: below the lowest bit of the smallest float and of any
/// border in the tests.
constexpr int unitBits = 310;

Integer exact(double value) {
    int exponent = 0;
    const double fraction = std::frexp(value, &exponent);
    Integer result = static_cast<long long>(std::ldexp(fraction, 53));
    const int shift = exponent - 53 + unitBits;
    if (shift >= 0)
        result <<= shift;
    else
        result >>= -shift;  // only zeros fall out: the tests' values have no lower bits
    return result;
}

struct Crossing {
    Integer numerator;
    Integer denominator;
    int axis;   ///< 0: x, 1: y
    int order;  ///< along the axis
    int step;
};

int compare(const Integer& n1, const Integer& d1, const Integer& n2, const Integer& d2) {
    const Integer left = n1 * d2;
    const Integer right = n2 * d1;
    return left < right ? -1 : left > right ? 1 : 0;
}

}  // namespace

ExactOracle::ExactOracle(const city::Heightfield& field) : field_(field) {}

ExactOracle::Answer ExactOracle::trace(const city::Ray& ray) const {
    Answer answer;
    for (int c = 0; c < 3; ++c)
        if (!std::isfinite(ray.origin[c]) || !std::isfinite(ray.direction[c])) {
            answer.status = TraceStatus::invalid;
            return answer;
        }
    if (ray.direction.x == 0 && ray.direction.y == 0 && ray.direction.z == 0) {
        answer.status = TraceStatus::invalid;
        return answer;
    }
    const Integer oz = exact(static_cast<double>(ray.origin.z));
    const Integer dz = exact(static_cast<double>(ray.direction.z));
    std::vector<Crossing> crossings;
    int cell[2];
    const int cells[2] = {field_.width(), field_.height()};
    for (int axis = 0; axis < 2; ++axis) {
        const Integer o = exact(static_cast<double>(ray.origin[axis]));
        const Integer d = exact(static_cast<double>(ray.direction[axis]));
        cell[axis] = -1;
        for (int k = 0; k <= cells[axis]; ++k) {
            const Integer plane = exact(field_.origin()[axis] +
                                        static_cast<double>(k) * static_cast<double>(field_.cellSize()));
            if (plane <= o) cell[axis] = k;
            if (d > 0 && plane > o) crossings.push_back({plane - o, d, axis, k, 1});
            if (d < 0 && plane <= o) crossings.push_back({o - plane, -d, axis, -k, -1});
        }
    }
    std::sort(crossings.begin(), crossings.end(), [](const Crossing& a, const Crossing& b) {
        const int byParameter = compare(a.numerator, a.denominator, b.numerator, b.denominator);
        if (byParameter != 0) return byParameter < 0;
        if (a.axis != b.axis) return a.axis < b.axis;
        return a.order < b.order;
    });

    const auto atOrBelow = [&](const Integer& n, const Integer& d, float h) {
        return oz * d + dz * n <= exact(static_cast<double>(h)) * d;
    };
    Integer n = 0, d = 1;
    for (std::size_t k = 0;; ++k) {
        if (cell[0] >= 0 && cell[0] < cells[0] && cell[1] >= 0 && cell[1] < cells[1]) {
            const float h = field_.at(cell[0], cell[1]);
            const bool endless = h == std::numeric_limits<float>::infinity();
            if (endless || (std::isfinite(h) && atOrBelow(n, d, h))) {
                answer = {TraceStatus::hit, {cell[0], cell[1]}, n, d};
                return answer;
            }
            if (std::isfinite(h) && dz < 0 &&
                (k == crossings.size() || atOrBelow(crossings[k].numerator, crossings[k].denominator, h))) {
                answer = {TraceStatus::hit, {cell[0], cell[1]}, oz - exact(static_cast<double>(h)), -dz};
                return answer;
            }
        }
        if (k == crossings.size()) return answer;
        cell[crossings[k].axis] += crossings[k].step;
        n = crossings[k].numerator;
        d = crossings[k].denominator;
    }
}

bool ExactOracle::withinBound(float t, const Answer& answer) {
    // Multiplied by the denominator and 2^unitBits.
    const Integer scaled = answer.numerator << unitBits;
    const Integer error = abs(exact(static_cast<double>(t)) * answer.denominator - scaled);
    return error <= (scaled >> 24) + (scaled >> 51) + (answer.denominator << (unitBits - 150));
}

bool ExactOracle::beyondFloats(const Answer& answer) {
    // Largest float plus half an ulp: 2^128 - 2^103.
    return answer.numerator >= answer.denominator * ((Integer(1) << 128) - (Integer(1) << 103));
}

}  // namespace reflection
