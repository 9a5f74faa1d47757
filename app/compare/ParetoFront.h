#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace app {

/// What something costs and how wrong it is; less of either is better.
struct CostAndError {
    double cost = 0;
    double error = 0;
};

/// The points that no other point beats: none is as good in both and better in one. Indices by rising cost
/// (and so falling error); of equal points the first alone. Points that are not finite are never on the
/// front. Cost: n log n.
std::vector<std::size_t> paretoFront(std::span<const CostAndError> points);

/// The least error that is had for a cost, along the front of `points`: that of the best point that costs no
/// more; +infinity where there is none.
double leastErrorFor(std::span<const CostAndError> points, double cost);

}  // namespace app
