#include "app/compare/ParetoFront.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/reflection/tracing/SeededRandom.h"

namespace app {
namespace {

/// By the definition: nobody is as good in both and better in one; of equals the first.
bool beaten(const std::vector<CostAndError>& points, std::size_t i) {
    for (std::size_t j = 0; j < points.size(); ++j) {
        const bool asGood = points[j].cost <= points[i].cost && points[j].error <= points[i].error;
        const bool better = points[j].cost < points[i].cost || points[j].error < points[i].error;
        if (asGood && (better || j < i)) return true;
    }
    return false;
}

TEST(ParetoFrontTest, isWhatNobodyBeats) {
    reflection::SeededRandom random(3);
    for (int round = 0; round < 200; ++round) {
        std::vector<CostAndError> points;
        // Few different values: many ties.
        for (int i = 0; i < 12; ++i)
            points.push_back({std::floor(random.between(0, 6)), std::floor(random.between(0, 6))});
        std::vector<std::size_t> expected;
        for (std::size_t i = 0; i < points.size(); ++i)
            if (!beaten(points, i)) expected.push_back(i);
        std::vector<std::size_t> front = paretoFront(points);
        for (std::size_t k = 1; k < front.size(); ++k) {
            EXPECT_GT(points[front[k]].cost, points[front[k - 1]].cost);
            EXPECT_LT(points[front[k]].error, points[front[k - 1]].error);
        }
        std::sort(front.begin(), front.end());
        EXPECT_EQ(front, expected);
    }
}

TEST(ParetoFrontTest, whatIsNotMeasuredIsNotOnIt) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const std::vector<CostAndError> points{{nan, 0}, {1, nan}, {2, 5}, {INFINITY, 0}};
    EXPECT_EQ(paretoFront(points), std::vector<std::size_t>{2});
    EXPECT_TRUE(paretoFront({}).empty());
}

TEST(ParetoFrontTest, leastErrorIsThatOfTheBestThatIsAffordable) {
    const std::vector<CostAndError> points{{1, 0.5}, {2, 0.7}, {3, 0.1}};
    EXPECT_EQ(leastErrorFor(points, 0.5), std::numeric_limits<double>::infinity());
    EXPECT_EQ(leastErrorFor(points, 1), 0.5);
    EXPECT_EQ(leastErrorFor(points, 2.9), 0.5);
    EXPECT_EQ(leastErrorFor(points, 3), 0.1);
}

}  // namespace
}  // namespace app
