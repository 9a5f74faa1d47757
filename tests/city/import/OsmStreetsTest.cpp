#include "city/import/OsmStreets.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include "city/import/OsmReader.h"
#include "city/import/StreetWidths.h"
#include "tests/city/import/OsmText.h"

namespace city {
namespace {

StreetPlan planOf(const OsmText& text, const char* name) {
    return planStreets(readOsm(text.save(name), {}));
}

TEST(OsmStreets, LanesAndDirectionsFromTags) {
    struct Case {
        OsmText::Tags tags;
        int forward;
        int backward;
    };
    const Case cases[] = {
        {{{"highway", "residential"}}, 1, 1},
        {{{"highway", "residential"}, {"oneway", "yes"}}, 1, 0},
        {{{"highway", "residential"}, {"oneway", "-1"}}, 0, 1},
        {{{"highway", "primary"}, {"lanes", "4"}}, 2, 2},
        {{{"highway", "primary"}, {"lanes", "3"}}, 2, 1},
        {{{"highway", "primary"}, {"lanes", "3"}, {"lanes:forward", "1"}}, 1, 2},
        {{{"highway", "primary"}, {"lanes", "3"}, {"lanes:backward", "2"}}, 1, 2},
        {{{"highway", "primary"}, {"lanes", "3"}, {"oneway", "yes"}}, 3, 0},
        {{{"highway", "tertiary"}, {"junction", "roundabout"}}, 1, 0},
        {{{"highway", "motorway"}}, 2, 0},
        {{{"highway", "primary"}, {"lanes", "99"}, {"oneway", "yes"}}, 6, 0},
        {{{"highway", "primary"}, {"lanes", "no idea"}}, 1, 1},
        {{{"highway", "primary"}, {"lanes", "1"}}, 1, 1},
    };
    for (const Case& c : cases) {
        OsmText text;
        text.bounds(200);
        text.line({{-100, 0}, {100, 0}}, c.tags);
        const StreetPlan plan = planOf(text, "lanes.osm");
        ASSERT_EQ(plan.graph.edges.size(), 1u);
        EXPECT_EQ(plan.graph.edges[0].lanesForward, c.forward) << c.tags.back().second;
        EXPECT_EQ(plan.graph.edges[0].lanesBackward, c.backward) << c.tags.back().second;
    }
}

TEST(OsmStreets, SplitWhereWaysShareNodesAndCutAtTheBounds) {
    OsmText text;
    text.bounds(100);
    const long middle = text.node(0, 0, {{"highway", "traffic_signals"}});
    text.way({text.node(-300, 0), middle, text.node(300, 0)}, {{"highway", "primary"}});
    text.way({text.node(0, -300), middle, text.node(0, 300)}, {{"highway", "residential"}});
    const StreetPlan plan = planOf(text, "cross.osm");
    ASSERT_EQ(plan.graph.edges.size(), 4u);
    ASSERT_EQ(plan.graph.nodes.size(), 5u);
    int signalled = 0;
    for (const auto& node : plan.graph.nodes) {
        signalled += node.signalled;
        EXPECT_LE(std::abs(node.position.x), 100.5f);
        EXPECT_LE(std::abs(node.position.y), 100.5f);
    }
    EXPECT_EQ(signalled, 1);
    EXPECT_EQ(plan.signals, 1u);
    for (const auto& edge : plan.graph.edges)
        EXPECT_NEAR(glm::distance(edge.shape.front(), edge.shape.back()), 100, 0.6);
}

TEST(OsmStreets, MissingNodesBreakAStreetInsteadOfBridgingTheGap) {
    OsmText text;
    text.bounds(100);
    const long a = text.node(-90, 0);
    const long b = text.node(-60, 0);
    const long c = text.node(60, 50);
    const long d = text.node(90, 50);
    text.way({a, b, 999001, 999002, c, d}, {{"highway", "residential"}});
    const OsmData data = readOsm(text.save("gap.osm"), {});
    EXPECT_EQ(data.missingNodeReferences, 2u);
    const StreetPlan plan = planStreets(data);
    ASSERT_EQ(plan.graph.edges.size(), 2u);
    for (const auto& edge : plan.graph.edges)
        EXPECT_NEAR(glm::distance(edge.shape.front(), edge.shape.back()), 30, 0.2);
}

TEST(OsmStreets, TunnelsFootwaysAndClosedRoadsCarryNoCars) {
    OsmText text;
    text.bounds(200);
    text.line({{-100, 0}, {100, 0}}, {{"highway", "primary"}, {"tunnel", "yes"}});
    text.line({{-100, 5}, {100, 5}}, {{"highway", "primary"}, {"layer", "-1"}});
    text.line({{-100, 10}, {100, 10}}, {{"highway", "footway"}});
    text.line({{-100, 20}, {100, 20}}, {{"highway", "construction"}});
    text.line({{-100, 30}, {100, 30}}, {{"highway", "residential"}, {"access", "no"}});
    text.line({{-100, 40}, {100, 40}}, {{"highway", "residential"}, {"bridge", "yes"}, {"layer", "1"}});
    const StreetPlan plan = planOf(text, "tunnels.osm");
    EXPECT_EQ(plan.graph.edges.size(), 1u);
    EXPECT_EQ(plan.tunnels, 2u);
    EXPECT_EQ(plan.bridges, 1u);
}

TEST(OsmStreets, TracksInAStreetMakeItATramStreetAndOthersAreLinesOfTheirOwn) {
    OsmText text;
    text.bounds(200);
    text.line({{-150, 0}, {150, 0}}, {{"highway", "primary"}, {"lanes", "4"}});
    text.line({{-150, 1.5}, {0, 1.5}, {150, 1.5}}, {{"railway", "tram"}});
    text.line({{-150, -1.5}, {0, -1.5}, {150, -1.5}}, {{"railway", "tram"}});
    text.line({{-150, 60}, {150, 60}}, {{"railway", "tram"}});
    text.line({{0, 80}, {0, 150}}, {{"highway", "residential"}});
    const StreetPlan plan = planOf(text, "trams.osm");
    ASSERT_EQ(plan.graph.edges.size(), 3u);
    EXPECT_TRUE(plan.graph.edges[0].tram && plan.graph.edges[0].cars);
    EXPECT_FALSE(plan.graph.edges[1].tram);
    EXPECT_TRUE(plan.graph.edges[2].tram && !plan.graph.edges[2].cars);
}

TEST(StreetWidths, CarriagewayFitsBetweenHouses) {
    StreetGraph graph;
    graph.nodes.resize(2);
    StreetGraph::Edge edge;
    edge.from = 0;
    edge.to = 1;
    edge.shape = {{-50, 0, 0}, {50, 0, 0}};
    edge.lanesForward = 2;
    edge.lanesBackward = 2;
    edge.laneWidth = 3.5f;
    graph.edges = {edge};
    const auto house = [](float y0, float y1) {
        return Footprint{{{-60, y0}, {60, y0}, {60, y1}, {-60, y1}}, {}};
    };
    StreetGraph wide = graph;
    EXPECT_EQ(fitStreetsBetween({house(9, 20), house(-20, -9)}, wide), 0u);
    EXPECT_EQ(fitStreetsBetween({house(5, 20), house(-20, -5)}, graph), 1u);
    const auto& narrow = graph.edges[0];
    EXPECT_LE(float(narrow.lanesForward + narrow.lanesBackward) * narrow.laneWidth / 2, 5.0f);
    EXPECT_GE(narrow.lanesForward, 1);
    EXPECT_GE(narrow.lanesBackward, 1);
    EXPECT_GE(narrow.laneWidth, 2.75f);
}

}  // namespace
}  // namespace city
