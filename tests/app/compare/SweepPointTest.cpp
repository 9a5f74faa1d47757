#include "app/compare/SweepPoint.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

namespace app {
namespace {

TEST(SweepPointTest, everyMethodIsThereWithOneDefault) {
    for (const bool raytrace : {false, true}) {
        std::set<std::string> methods;
        std::map<std::string, int> defaults;
        for (const SweepPoint& p : comparedPoints(raytrace)) {
            methods.insert(p.method);
            defaults[p.title()] += p.isDefault ? 1 : 0;
        }
        EXPECT_EQ(methods.size(), comparedMethods.size() - (raytrace ? 0 : 1));
        for (const auto& [title, count] : defaults) EXPECT_EQ(count, 1) << title;
    }
    // What every time is compared with comes first.
    EXPECT_EQ(comparedPoints(true).front().method, "none");
}

TEST(SweepPointTest, noTwoPointsLookOrAreTheSame) {
    std::set<std::string> seen, set;
    for (const SweepPoint& p : comparedPoints(true)) {
        EXPECT_TRUE(seen.insert(p.title() + ": " + p.setting).second) << p.setting;
        EXPECT_TRUE(set.insert(p.title() + settingsOf(p).dump()).second) << settingsOf(p);
    }
}

TEST(SweepPointTest, whatIsComparedInSeveralViewsHasItsYardsticks) {
    std::set<std::string> methods;
    for (const SweepPoint& p : comparedPoints(true))
        if (p.severalViews) {
            methods.insert(p.title());
            EXPECT_TRUE(p.isDefault);
        }
    EXPECT_THAT(methods, testing::ElementsAre("mem", "none", "raytrace", "rerender"));
}

TEST(SweepPointTest, settingsNameWhatMattersAlone) {
    for (const SweepPoint& p : comparedPoints(true)) {
        const auto set = settingsOf(p);
        EXPECT_EQ(set.contains("samples"), p.method == "raytrace");
        EXPECT_EQ(set.contains("candidates"), p.title() == "mem");
        EXPECT_FALSE(set.contains("every_frame") && set.contains("texel_budget")) << p.setting;
        if (p.method == "rerender") {
            EXPECT_NE(set.contains("maps_in_turn"), set.contains("every_frame")) << p.setting;
        }
    }
}

}  // namespace
}  // namespace app
