#include "app/report/Timing.h"

#include <algorithm>

namespace app {

Timing timingOf(std::vector<double> milliseconds) {
    if (milliseconds.empty()) return {};
    Timing timing;
    timing.n = milliseconds.size();
    const auto [low, high] = std::minmax_element(milliseconds.begin(), milliseconds.end());
    timing.min = *low;
    timing.max = *high;
    const auto middle = milliseconds.begin() + static_cast<std::ptrdiff_t>(timing.n / 2);
    std::nth_element(milliseconds.begin(), middle, milliseconds.end());
    timing.median = *middle;
    if (timing.n % 2 == 0)
        timing.median = 0.5 * (timing.median + *std::max_element(milliseconds.begin(), middle));
    return timing;
}

}  // namespace app
