#pragma once

#include <cmath>
#include <cstdint>
#include <initializer_list>

namespace app::stability {

/// splitmix64 (Steele, Lea, Flood 2014): the same numbers on every machine.
class SeededRandom {
  public:
    /// Streams of one seed are independent of each other.
    explicit SeededRandom(std::uint64_t seed, std::uint64_t stream = 0)
        : state_(seed * 0xd1342543de82ef95ULL + stream * 0x2545f4914f6cdd1dULL) {
        next();
        state_ ^= next();
    }

    std::uint64_t next() {
        std::uint64_t z = (state_ += 0x9e3779b97f4a7c15ULL);
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
        return z ^ (z >> 31);
    }
    int below(int n) { return static_cast<int>((next() >> 33) * static_cast<std::uint64_t>(n) >> 31); }
    bool oneIn(int n) { return below(n) == 0; }
    /// In [0, 1).
    double unit() { return static_cast<double>(next() >> 11) * 0x1p-53; }
    double between(double low, double high) { return low + (high - low) * unit(); }
    /// Evenly spread over the magnitudes.
    double magnitude(double low, double high) { return std::exp(between(std::log(low), std::log(high))); }
    float oneOf(std::initializer_list<float> values) {
        return values.begin()[below(static_cast<int>(values.size()))];
    }

  private:
    std::uint64_t state_ = 0;
};

}  // namespace app::stability
