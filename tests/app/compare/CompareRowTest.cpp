#include "app/compare/CompareRow.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace app {
namespace {

CompareRow row(const std::string& method, double ms, double flip, bool isDefault = false,
               const std::string& variant = "") {
    CompareRow r;
    r.point.method = method;
    r.point.variant = variant;
    r.point.setting = method + " at " + std::to_string(ms);
    r.point.isDefault = isDefault;
    r.cars = 10;
    r.reflection = {ms, ms, ms, 3};
    r.frame = {ms + 20, ms + 20, ms + 20, 3};
    r.againstTruth.flip = flip;
    return r;
}

FrontVerdict about(const std::vector<FrontVerdict>& verdicts, const std::string& other) {
    for (const FrontVerdict& v : verdicts)
        if (v.other == other) return v;
    return {};
}

TEST(CompareRowTest, frontsAreThoseOfTheirCarsAndViews) {
    std::vector<CompareRow> rows{row("mem", 1, 0.04), row("box", 2, 0.05), row("box", 2, 0.05)};
    rows[2].views = "eyes";
    // The clock's noise below nothing does not make a point cheaper than one that costs nothing.
    rows.push_back(row("static", -3, 0.2));
    rows.push_back(row("none", 0, 0.1, true));
    markFronts(rows);
    EXPECT_TRUE(rows[0].onFront);
    EXPECT_FALSE(rows[1].onFront);
    EXPECT_TRUE(rows[2].onFront);
    EXPECT_FALSE(rows[3].onFront);
    EXPECT_TRUE(rows[4].onFront);
}

TEST(CompareRowTest, verdictsCountBetweenTheCheapestPointAndReRendering) {
    const std::vector<CompareRow> rows{
        row("mem", 2, 0.04),     row("mem", 5, 0.02),          row("box", 1, 0.09),
        row("box", 3, 0.05),     row("box", 6, 0.01),          row("box", 99, 0),
        row("rerender", 3, 0.1), row("rerender", 50, 0, true), row("mem", 4, 0.06, true, "paper")};
    const std::vector<FrontVerdict> verdicts = frontVerdicts(rows);
    EXPECT_EQ(about(verdicts, "box").points, 2u) << "one is cheaper than mem's cheapest, one dearer than all";
    EXPECT_EQ(about(verdicts, "box").below, 1u);
    EXPECT_EQ(about(verdicts, "rerender").points, 1u) << "in turn; full re-rendering is the end";
    EXPECT_EQ(about(verdicts, "rerender").below, 1u);
    EXPECT_EQ(about(verdicts, "mem paper").below, 1u);
    EXPECT_TRUE(frontVerdicts({}).empty());
    EXPECT_TRUE(frontVerdicts({row("box", 1, 0.1)}).empty());
}

TEST(CompareRowTest, jsonHasTheUsualNamesAndNullForWhatWasNotMeasured) {
    CompareRow r = row("mem", 2, 0.04, true);
    r.againstRerender.flip = 0.03;
    const nlohmann::json json = nlohmann::json::parse(toJson(r, "paper").dump());
    for (const char* name : {"method", "city", "cars", "visible", "width", "height", "frame_ms",
                             "reflection_ms", "ratio_to_none", "ratio_to_rerender", "maps_updated_per_frame",
                             "psnr_db", "mean_flip", "ssim", "texture_bytes", "set", "on_front", "flicker"})
        EXPECT_TRUE(json.contains(name)) << name;
    EXPECT_EQ(json["mean_flip"], 0.04);
    EXPECT_EQ(json["against_rerender"]["mean_flip"], 0.03);
    EXPECT_TRUE(json["psnr_db"].is_null());
    EXPECT_EQ(json["reflection_ms"]["median"], 2);
}

}  // namespace
}  // namespace app
