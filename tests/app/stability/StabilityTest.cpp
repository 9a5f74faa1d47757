// Every row of every campaign is within its bound: the short form of `mirrorstreet stability`.
#include "app/stability/Stability.h"

#include <gtest/gtest.h>

#include <limits>

namespace app::stability {
namespace {

class StabilityTest : public testing::TestWithParam<Campaign> {};

TEST_P(StabilityTest, everyRowIsWithinItsBound) {
    const std::vector<Row> rows = GetParam().run({});
    EXPECT_FALSE(rows.empty());
    for (const Row& row : rows) {
        EXPECT_TRUE(row.passed()) << describe(row);
        EXPECT_EQ(row.group, GetParam().name);
        if (row.judged()) {
            EXPECT_FALSE(row.boundFrom.empty()) << row.what;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Campaigns, StabilityTest, testing::ValuesIn(allCampaigns()),
                         [](const auto& campaign) { return campaign.param.name; });

TEST(StabilityRowTest, failuresErrorsAndNothingTriedAreOutside) {
    const Row good{"g", "w", 10, 0, 0.5, 1, "m", "b", ""};
    EXPECT_TRUE(good.passed());
    Row row = good;
    row.failures = 1;
    EXPECT_FALSE(row.passed());
    row = good;
    row.worst = 1.5;
    EXPECT_FALSE(row.passed());
    row.worst = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(row.passed());
    row = good;
    row.tried = 0;
    EXPECT_FALSE(row.passed());
    row = good;
    row.bound = std::numeric_limits<double>::infinity();
    row.failures = 3;
    EXPECT_TRUE(row.passed()) << "counted for comparison only";
    EXPECT_FALSE(row.judged());
}

TEST(StabilityRowTest, campaignsRepeatBitForBit) {
    Options options;
    options.rays = 1;
    options.seed = 7;
    const std::vector<Row> once = tryTracer(options), again = tryTracer(options);
    ASSERT_EQ(once.size(), again.size());
    for (std::size_t k = 0; k < once.size(); ++k) {
        if (once[k].unit == "s") continue;
        EXPECT_EQ(toJson(once[k]).dump(), toJson(again[k]).dump());
    }
}

}  // namespace
}  // namespace app::stability
