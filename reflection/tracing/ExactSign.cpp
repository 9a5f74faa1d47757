#include "reflection/tracing/ExactSign.h"

#include <array>
#include <cmath>

namespace reflection {

namespace {

struct Pair {
    double high;
    double low;  ///< high + low is the exact result
};

Pair twoSum(double a, double b) {
    const double sum = a + b;
    const double partOfB = sum - a;
    const double partOfA = sum - partOfB;
    return {sum, (a - partOfA) + (b - partOfB)};
}

Pair twoProduct(double a, double b) {
    const double product = a * b;
    return {product, std::fma(a, b, -product)};
}

/// A sum of doubles kept exactly: components in increasing magnitude that do not overlap (Shewchuk's
/// grow-expansion), so that the last non-zero one carries the sign.
struct Expansion {
    std::array<double, 8> part{};
    int count = 0;

    void add(double value) {
        double carry = value;
        for (int k = 0; k < count; ++k) {
            const Pair sum = twoSum(carry, part[static_cast<std::size_t>(k)]);
            part[static_cast<std::size_t>(k)] = sum.low;
            carry = sum.high;
        }
        part[static_cast<std::size_t>(count++)] = carry;
    }

    int sign() const {
        for (int k = count - 1; k >= 0; --k) {
            if (part[static_cast<std::size_t>(k)] > 0) return 1;
            if (part[static_cast<std::size_t>(k)] < 0) return -1;
        }
        return 0;
    }
};

void addProduct(Expansion& sum, Pair difference, double factor) {
    const Pair low = twoProduct(difference.low, factor);
    const Pair high = twoProduct(difference.high, factor);
    sum.add(low.low);
    sum.add(low.high);
    sum.add(high.low);
    sum.add(high.high);
}

}  // namespace

int signOfDifference(double a1, double a0, double p, double b1, double b0, double q) {
    // Each product carries two roundings, their difference a third: in all less than 2.01 * 2^-53 of |ap| +
    // |bq|. The filter allows four times as much. It never decides near the range in which doubles lose bits:
    // 1e-280.
    const double ap = (a1 - a0) * p;
    const double bq = (b1 - b0) * q;
    const double difference = ap - bq;
    const double bound = 0x1p-50 * (std::abs(ap) + std::abs(bq)) + 1e-280;
    if (difference > bound) return 1;
    if (difference < -bound) return -1;

    Expansion sum;
    addProduct(sum, twoSum(a1, -a0), p);
    addProduct(sum, twoSum(b1, -b0), -q);
    return sum.sign();
}

}  // namespace reflection
