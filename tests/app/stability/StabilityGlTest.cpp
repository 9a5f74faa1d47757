// Drawing at the edges of its range: the part of `mirrorstreet stability` that needs OpenGL.
#include <gtest/gtest.h>

#include "app/stability/DrawingCampaign.h"

namespace app::stability {
namespace {

TEST(StabilityGlTest, everyTargetQualityAndCrowdIsDrawn) {
    const std::vector<Row> rows = tryDrawing({});
    EXPECT_EQ(rows.size(), 8u);
    for (const Row& row : rows) EXPECT_TRUE(row.passed()) << describe(row);
}

}  // namespace
}  // namespace app::stability
