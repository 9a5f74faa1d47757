#pragma once

#include <cstddef>
#include <cstdint>

namespace city {

/// SplitMix64 (Steele, Lea, Flood 2014) with distributions of its own: the same numbers from the same seed
/// with every compiler and library, which std::uniform_real_distribution does not promise.
class Random {
  public:
    explicit Random(std::uint64_t seed) : state_(seed) {}

    std::uint64_t next() {
        std::uint64_t z = (state_ += 0x9e3779b97f4a7c15ull);
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
        return z ^ (z >> 31);
    }
    /// [0, 1), 53 bits.
    double uniform() { return static_cast<double>(next() >> 11) * 0x1p-53; }
    /// [low, high].
    float range(float low, float high) {
        return static_cast<float>(static_cast<double>(low) + uniform() * (static_cast<double>(high) - low));
    }
    /// Both ends included; low when high < low.
    int integer(int low, int high) {
        if (high < low) return low;
        return low + static_cast<int>(next() % static_cast<std::uint64_t>(high - low + 1));
    }
    bool chance(double probability) { return uniform() < probability; }
    /// An index below `count`; count must not be 0.
    std::size_t index(std::size_t count) { return static_cast<std::size_t>(next() % count); }
    /// A stream of its own for a part, so that a change in one part leaves the others as they were.
    Random fork(std::uint64_t part) const {
        Random mixed(state_ ^ (part * 0xd1342543de82ef95ull + 0x632be59bd9b4e019ull));
        mixed.next();
        return Random(mixed.next());
    }

  private:
    std::uint64_t state_;
};

/// Sine and cosine of a number of full turns. Only additions and products of doubles, so that it gives the
/// same bits everywhere, which the C library's functions do not promise. Error below 1e-7.
struct Turn {
    float sin, cos;
    explicit Turn(double turns);
};

}  // namespace city
