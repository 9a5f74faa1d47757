#pragma once

#include <chrono>
#include <cstddef>
#include <vector>

namespace app {

/// What many measurements of one thing come to, in milliseconds.
struct Timing {
    double min = 0;
    double median = 0;
    double max = 0;
    std::size_t n = 0;  ///< 0: nothing was measured, and the other numbers mean nothing
};

/// The median of an even number is the mean of the middle two. Cost: linear.
Timing timingOf(std::vector<double> milliseconds);

/// Milliseconds since construction or the last `lap`.
class Stopwatch {
  public:
    double elapsed() const {
        return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count();
    }
    /// The time elapsed, and starts again.
    double lap() {
        const double milliseconds = elapsed();
        start_ = std::chrono::steady_clock::now();
        return milliseconds;
    }

  private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace app
