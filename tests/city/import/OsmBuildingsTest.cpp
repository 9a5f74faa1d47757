#include "city/import/OsmBuildings.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "city/import/OsmHeights.h"
#include "city/import/OsmReader.h"
#include "city/model/PolygonAlgebra.h"
#include "tests/city/import/OsmText.h"

namespace city {
namespace {

BuildingPlans planOf(const OsmText& text, const char* name) {
    MaterialTable table;
    return planBuildings(readOsm(text.save(name), {}), {}, 1, table);
}

TEST(OsmBuildings, HeightsFromAllTheirTags) {
    OsmText text;
    text.bounds(300);
    text.box(0, 0, 20, 20, {{"building", "yes"}, {"height", "12.13 m"}});
    text.box(30, 0, 50, 20, {{"building", "apartments"}, {"building:levels", "5"}});
    text.box(60, 0, 80, 20, {{"building", "yes"}, {"height", "40&apos;"}, {"min_height", "3"}});
    text.box(90, 0, 110, 20, {{"building", "yes"}, {"height", "10"}, {"min_height", "12"}});
    text.box(120, 0, 140, 20, {{"building", "yes"}, {"height", "-4"}, {"building:levels", "2"}});
    const BuildingPlans result = planOf(text, "heights.osm");
    ASSERT_EQ(result.plans.size(), 5u);
    EXPECT_FLOAT_EQ(result.plans[0].shape.eaves, 12.13f);
    EXPECT_FLOAT_EQ(result.plans[1].shape.eaves, float(5 * storeyHeight(BuildingKind::block)));
    EXPECT_FLOAT_EQ(result.plans[2].shape.eaves, 12.192f);
    EXPECT_FLOAT_EQ(result.plans[2].shape.base, 3);
    EXPECT_FLOAT_EQ(result.plans[3].shape.base, 0);  // a base above the top is an error
    EXPECT_FLOAT_EQ(result.plans[4].shape.eaves, float(2 * storeyHeight(BuildingKind::block)));
    EXPECT_EQ(result.guessedHeights, 0u);
}

TEST(OsmBuildings, UnknownHeightIsTheMedianOfItsNeighbours) {
    OsmText text;
    text.bounds(300);
    const double heights[] = {20, 21, 22, 23, 60};
    for (int i = 0; i < 5; ++i)
        text.box(30 * i, 0, 30 * i + 20, 20, {{"building", "yes"}, {"height", std::to_string(heights[i])}});
    text.box(60, 40, 80, 60, {{"building", "apartments"}});
    text.box(100, 40, 104, 44, {{"building", "shed"}});
    const BuildingPlans result = planOf(text, "guess.osm");
    EXPECT_EQ(result.guessedHeights, 2u);
    ASSERT_EQ(result.plans.size(), 7u);
    EXPECT_FLOAT_EQ(result.plans[5].shape.eaves, 22);
    EXPECT_LT(result.plans[6].shape.eaves, 4);  // a shed does not grow with its neighbours
}

TEST(OsmBuildings, PartsReplaceTheirOutline) {
    OsmText text;
    text.bounds(300);
    text.box(0, 0, 40, 20, {{"building", "yes"}, {"height", "50"}, {"building:colour", "red"}});
    text.box(0, 0, 20, 20, {{"building:part", "yes"}, {"height", "50"}});
    text.box(20, 0, 40, 20, {{"building:part", "yes"}, {"height", "10"}});
    const BuildingPlans result = planOf(text, "parts.osm");
    EXPECT_EQ(result.replacedOutlines, 1u);
    EXPECT_EQ(result.keptRemainders, 0u);
    ASSERT_EQ(result.plans.size(), 2u);
    double covered = 0;
    for (const BuildingPlan& plan : result.plans) covered += area(plan.shape.footprint);
    EXPECT_NEAR(covered, 800, 8);  // coordinates have seven digits: a centimetre
}

TEST(OsmBuildings, WhatPartsLeaveFreeOfTheirOutlineStaysBuilt) {
    OsmText text;
    text.bounds(300);
    text.box(0, 0, 40, 20, {{"building", "yes"}, {"height", "50"}});
    text.box(0, 0, 10, 20, {{"building:part", "yes"}, {"height", "50"}});
    text.box(10, 0, 20, 20, {{"building:part", "yes"}, {"height", "12"}});
    text.box(20, 0, 25, 20, {{"building:part", "yes"}, {"height", "12"}});
    const BuildingPlans result = planOf(text, "remainder.osm");
    EXPECT_EQ(result.keptRemainders, 1u);
    ASSERT_EQ(result.plans.size(), 4u);
    const auto rest = std::max_element(
        result.plans.begin(), result.plans.end(),
        [](const auto& a, const auto& b) { return area(a.shape.footprint) < area(b.shape.footprint); });
    EXPECT_NEAR(area(rest->shape.footprint), 300, 10);
    EXPECT_FLOAT_EQ(rest->shape.eaves, 12);  // not the tower's 50
}

TEST(OsmBuildings, MultipolygonKeepsItsCourtyardsAndIsNotBuiltTwice) {
    OsmText text;
    text.bounds(300);
    const long outer = text.box(0, 0, 60, 60, {{"building", "yes"}});
    const long inner = text.box(20, 20, 40, 40, {});
    const long second = text.box(45, 20, 55, 40, {});
    text.multipolygon({{outer, "outer"}, {inner, "inner"}, {second, "inner"}},
                      {{"building", "yes"}, {"height", "18"}});
    const BuildingPlans result = planOf(text, "court.osm");
    ASSERT_EQ(result.plans.size(), 1u);
    EXPECT_EQ(result.plans[0].shape.footprint.holes.size(), 2u);
    EXPECT_NEAR(area(result.plans[0].shape.footprint), 3600 - 400 - 200, 15);
}

TEST(OsmBuildings, OuterRingOfSeveralWaysIsJoined) {
    OsmText text;
    text.bounds(300);
    const long a = text.node(0, 0);
    const long b = text.node(30, 0);
    const long c = text.node(30, 20);
    const long d = text.node(0, 20);
    const long first = text.way({a, b, c}, {});
    const long second = text.way({a, d, c}, {});  // runs the other way round
    text.multipolygon({{first, "outer"}, {second, "outer"}}, {{"building", "yes"}});
    const BuildingPlans result = planOf(text, "joined.osm");
    ASSERT_EQ(result.plans.size(), 1u);
    EXPECT_NEAR(area(result.plans[0].shape.footprint), 600, 6);
}

TEST(OsmBuildings, UndergroundAndOutsideAreLeftOut) {
    OsmText text;
    text.bounds(100);
    text.box(0, 0, 20, 20, {{"building", "yes"}, {"location", "underground"}});
    text.box(0, 30, 20, 50, {{"building", "yes"}, {"layer", "-1"}});
    text.box(500, 0, 520, 20, {{"building", "yes"}});
    text.box(-50, 0, -30, 20, {{"building", "yes"}});
    const BuildingPlans result = planOf(text, "outside.osm");
    EXPECT_EQ(result.underground, 2u);
    EXPECT_EQ(result.outside, 1u);
    EXPECT_EQ(result.plans.size(), 1u);
}

TEST(OsmBuildings, ShopsMakeShopFronts) {
    OsmText text;
    text.bounds(200);
    text.box(0, 0, 20, 20, {{"building", "apartments"}, {"building:levels", "6"}});
    text.node(10, -1, {{"shop", "bakery"}});  // at the door, outside
    text.box(60, 0, 80, 20, {{"building", "apartments"}, {"building:levels", "6"}});
    const BuildingPlans result = planOf(text, "shops.osm");
    ASSERT_EQ(result.plans.size(), 2u);
    EXPECT_GT(result.plans[0].shape.groundFloorHeight, 3);
    EXPECT_FLOAT_EQ(result.plans[1].shape.groundFloorHeight, 0);
}

TEST(OsmBuildings, PartsThatShareWallsDoNotCoincide) {
    OsmText text;
    text.bounds(300);
    text.box(0, 0, 40, 20, {{"building", "yes"}});
    text.box(0, 0, 40, 20, {{"building:part", "yes"}, {"height", "10"}});
    text.box(0, 0, 10, 20, {{"building:part", "yes"}, {"height", "30"}});
    const BuildingPlans result = planOf(text, "coincide.osm");
    ASSERT_EQ(result.plans.size(), 2u);
    const auto left = [](const BuildingPlan& plan) {
        float x = 1e9f;
        for (const glm::vec2 p : plan.shape.footprint.outer) x = std::min(x, p.x);
        return x;
    };
    EXPECT_GT(left(result.plans[1]) - left(result.plans[0]), 0.01f);
    EXPECT_LT(left(result.plans[1]) - left(result.plans[0]), 0.2f);
}

TEST(OsmBuildings, DomeOnItsDrumAndCrossInTheAir) {
    OsmText text;
    text.bounds(300);
    text.box(0, 0, 40, 20, {{"building", "church"}, {"height", "12"}});
    text.box(0, 0, 40, 20, {{"building:part", "yes"}, {"height", "12"}});
    text.box(10, 5, 18, 13,
             {{"building", "church"},
              {"building:part", "yes"},
              {"min_height", "12"},
              {"roof:shape", "dome"},
              {"roof:height", "5"}});
    text.box(30, 5, 31, 6, {{"building:part", "yes"}, {"min_height", "37"}, {"height", "41"}});
    const BuildingPlans result = planOf(text, "dome.osm");
    EXPECT_EQ(result.floating, 1u);
    ASSERT_EQ(result.plans.size(), 2u);
    EXPECT_EQ(result.plans[1].shape.roof, RoofShape::dome);
    EXPECT_FLOAT_EQ(result.plans[1].shape.ridge, 17);
    EXPECT_FLOAT_EQ(result.plans[1].shape.base, 12);
}

TEST(OsmBuildings, RoofHeightIsPartOfTheHeight) {
    OsmText text;
    text.bounds(200);
    text.box(0, 0, 20, 10,
             {{"building", "house"}, {"height", "9"}, {"roof:shape", "hipped"}, {"roof:height", "3"}});
    const BuildingPlans result = planOf(text, "roof.osm");
    ASSERT_EQ(result.plans.size(), 1u);
    EXPECT_FLOAT_EQ(result.plans[0].shape.eaves, 6);
    EXPECT_FLOAT_EQ(result.plans[0].shape.ridge, 9);
    EXPECT_EQ(result.plans[0].shape.roof, RoofShape::hipped);
}

}  // namespace
}  // namespace city
