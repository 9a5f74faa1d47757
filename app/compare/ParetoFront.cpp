#include "app/compare/ParetoFront.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace app {

std::vector<std::size_t> paretoFront(std::span<const CostAndError> points) {
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < points.size(); ++i)
        if (std::isfinite(points[i].cost) && std::isfinite(points[i].error)) order.push_back(i);
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return points[a].cost != points[b].cost ? points[a].cost < points[b].cost
                                                : points[a].error < points[b].error;
    });
    std::vector<std::size_t> front;
    for (const std::size_t i : order)
        if (front.empty() || points[i].error < points[front.back()].error) front.push_back(i);
    return front;
}

double leastErrorFor(std::span<const CostAndError> points, double cost) {
    double least = std::numeric_limits<double>::infinity();
    for (const CostAndError& p : points)
        if (p.cost <= cost) least = std::fmin(least, p.error);
    return least;
}

}  // namespace app
