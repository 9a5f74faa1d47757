#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "city/roads/BuildRoadNetwork.h"
#include "tests/city/roads/TestStreets.h"

namespace {

using city::RoadNetwork;
using city::StreetGraph;

/// What every network must keep, whatever it was made from.
void expectSound(const RoadNetwork& roads) {
    for (const city::Lane& lane : roads.lanes) {
        ASSERT_GE(lane.centreLine.size(), 2U);
        for (std::size_t i = 0; i < lane.centreLine.size(); ++i) {
            const glm::vec3& p = lane.centreLine[i];
            ASSERT_TRUE(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
            if (i > 0) {
                ASSERT_NE(p, lane.centreLine[i - 1]);
            }
        }
        ASSERT_FALSE(lane.connections.empty());
        ASSERT_GT(lane.speedLimit, 0);
        ASSERT_GT(lane.width, 0);
    }
    for (std::size_t c = 0; c < roads.connections.size(); ++c) {
        const city::Connection& connection = roads.connections[c];
        ASSERT_LT(connection.fromLane, roads.lanes.size());
        ASSERT_LT(connection.toLane, roads.lanes.size());
        ASSERT_LT(connection.junction, roads.junctions.size());
        ASSERT_EQ(roads.lanes[connection.fromLane].kind, roads.lanes[connection.toLane].kind);
        ASSERT_GE(connection.centreLine.size(), 2U);
        ASSERT_EQ(connection.centreLine.front(), roads.lanes[connection.fromLane].centreLine.back());
        ASSERT_EQ(connection.centreLine.back(), roads.lanes[connection.toLane].centreLine.front());
        for (const glm::vec3& p : connection.centreLine)
            ASSERT_TRUE(std::isfinite(p.x) && std::isfinite(p.y));
        const auto& back = roads.lanes[connection.fromLane].connections;
        ASSERT_NE(std::find(back.begin(), back.end(), c), back.end());
        for (std::uint32_t other : connection.conflicts) {
            const auto& mutual = roads.connections[other].conflicts;
            ASSERT_NE(std::find(mutual.begin(), mutual.end(), c), mutual.end());
        }
        for (std::uint32_t other : connection.yieldsTo) {
            ASSERT_NE(std::find(connection.conflicts.begin(), connection.conflicts.end(), other),
                      connection.conflicts.end());
            const auto& yields = roads.connections[other].yieldsTo;
            ASSERT_EQ(std::find(yields.begin(), yields.end(), c), yields.end()) << "both yield: nobody goes";
        }
        const city::Signal& signal = roads.junctions[connection.junction].signal;
        if (signal.phases.empty()) {
            ASSERT_EQ(connection.signalGroup, city::noIndex);
        } else {
            const bool everGreen =
                std::any_of(signal.phases.begin(), signal.phases.end(), [&](const auto& phase) {
                    return !phase.amber && std::count(phase.greenGroups.begin(), phase.greenGroups.end(),
                                                      connection.signalGroup);
                });
            ASSERT_TRUE(everGreen);
        }
    }
}

std::vector<double> turnsFrom(const RoadNetwork& roads, std::uint32_t lane) {
    std::vector<double> turns;
    for (std::uint32_t c : roads.lanes[lane].connections) {
        const auto& line = roads.connections[c].centreLine;
        const glm::vec3 u = line[1] - line[0];
        const glm::vec3 v = line.back() - line[line.size() - 2];
        turns.push_back(std::atan2(u.x * v.y - u.y * v.x, u.x * v.x + u.y * v.y));
    }
    return turns;
}

TEST(RoadNetwork, gridIsSoundAndDrivesOnTheRight) {
    const StreetGraph graph = test_streets::grid(3, 100, true);
    const RoadNetwork roads = city::buildRoadNetwork(graph);
    expectSound(roads);
    // Every lane of a street along x that runs east lies south of the axis.
    for (const city::Lane& lane : roads.lanes) {
        const glm::vec3 d = lane.centreLine.back() - lane.centreLine.front();
        if (std::abs(d.y) > 1 || std::abs(d.x) < 20) continue;
        const float axis = 100 * std::round(lane.centreLine.front().y / 100);
        EXPECT_GT((axis - lane.centreLine.front().y) * d.x, 0);
    }
}

TEST(RoadNetwork, crossingOffersRightStraightAndLeftFromASingleLane) {
    const RoadNetwork roads = city::buildRoadNetwork(test_streets::grid(3, 100, false, false));
    int full = 0;
    for (std::uint32_t i = 0; i < roads.lanes.size(); ++i) {
        std::vector<double> turns = turnsFrom(roads, i);
        if (turns.size() != 3) continue;
        std::sort(turns.begin(), turns.end());
        EXPECT_NEAR(turns[0], -1.57, 0.2);
        EXPECT_NEAR(turns[1], 0, 0.1);
        EXPECT_NEAR(turns[2], 1.57, 0.2);
        ++full;
    }
    EXPECT_EQ(full, 4);  // the four approaches of the only node where four streets meet
}

TEST(RoadNetwork, innerLaneOfAnAvenueDoesNotTurnRightNorTheOuterOneLeft) {
    const RoadNetwork roads = city::buildRoadNetwork(test_streets::grid(3, 100, true));
    for (std::uint32_t i = 0; i < roads.lanes.size(); ++i) {
        const city::Lane& lane = roads.lanes[i];
        const bool ofAvenue = lane.leftNeighbour != city::noIndex || lane.rightNeighbour != city::noIndex;
        if (!ofAvenue || turnsFrom(roads, i).size() < 2) continue;
        for (double turn : turnsFrom(roads, i)) {
            if (lane.leftNeighbour == city::noIndex) {
                EXPECT_GT(turn, -0.5);
            }
            if (lane.rightNeighbour == city::noIndex) {
                EXPECT_LT(turn, 0.5);
            }
        }
    }
}

TEST(RoadNetwork, curvesHavePointsAtMostAMetreApartAndNoKinks) {
    const RoadNetwork roads = city::buildRoadNetwork(test_streets::grid(3, 100, false));
    for (const city::Connection& connection : roads.connections) {
        const auto& line = connection.centreLine;
        for (std::size_t i = 1; i < line.size(); ++i) EXPECT_LE(glm::distance(line[i - 1], line[i]), 1.0f);
        for (std::size_t i = 2; i < line.size(); ++i) {
            const glm::vec3 u = glm::normalize(line[i - 1] - line[i - 2]);
            const glm::vec3 v = glm::normalize(line[i] - line[i - 1]);
            EXPECT_GT(glm::dot(u, v), std::cos(0.35f));
        }
    }
}

TEST(RoadNetwork, crossingPathsConflictAndParallelOnesDoNot) {
    const RoadNetwork roads = city::buildRoadNetwork(test_streets::grid(3, 100, false, false));
    for (const city::Junction& junction : roads.junctions) {
        for (std::uint32_t a : junction.connections) {
            for (std::uint32_t b : junction.connections) {
                const auto& ca = roads.connections[a];
                const auto& cb = roads.connections[b];
                if (ca.fromLane == cb.fromLane) continue;
                // Oracle: closest distance of the two curves' points.
                float closest = 1e9f;
                for (const glm::vec3& p : ca.centreLine) {
                    for (const glm::vec3& q : cb.centreLine) closest = std::min(closest, glm::distance(p, q));
                }
                const bool listed = std::count(ca.conflicts.begin(), ca.conflicts.end(), b) > 0;
                if (closest < 1.5f) {
                    EXPECT_TRUE(listed);
                }
                if (closest > 3.2f) {
                    EXPECT_FALSE(listed);
                }
            }
        }
    }
}

TEST(RoadNetwork, signalsNeverShowGreenToCrossingStraightWays) {
    const RoadNetwork roads = city::buildRoadNetwork(test_streets::grid(3, 100, true));
    int signals = 0;
    for (const city::Junction& junction : roads.junctions) {
        if (junction.signal.phases.empty()) continue;
        ++signals;
        EXPECT_GE(junction.signal.phases.size(), 6U);  // two directions: green, amber, all red
        for (const city::SignalPhase& phase : junction.signal.phases) {
            const auto green = [&](std::uint32_t c) {
                return std::count(phase.greenGroups.begin(), phase.greenGroups.end(),
                                  roads.connections[c].signalGroup) > 0;
            };
            for (std::uint32_t a : junction.connections) {
                for (std::uint32_t b : roads.connections[a].conflicts) {
                    if (!green(a) || !green(b)) continue;
                    // What is green together must be settled by right of way.
                    const auto& ya = roads.connections[a].yieldsTo;
                    const auto& yb = roads.connections[b].yieldsTo;
                    EXPECT_TRUE(std::count(ya.begin(), ya.end(), b) || std::count(yb.begin(), yb.end(), a));
                }
            }
        }
    }
    EXPECT_EQ(signals, 1);
}

TEST(RoadNetwork, deadEndTurnsBack) {
    StreetGraph graph;
    test_streets::addNode(graph, 0, 0);
    test_streets::addNode(graph, 80, 0);
    test_streets::addEdge(graph, 0, 1);
    const RoadNetwork roads = city::buildRoadNetwork(graph);
    expectSound(roads);
    ASSERT_EQ(roads.lanes.size(), 2U);
    ASSERT_EQ(roads.connections.size(), 2U);
    for (const city::Connection& c : roads.connections) EXPECT_NE(c.fromLane, c.toLane);
}

TEST(RoadNetwork, bendIsNoJunction) {
    StreetGraph graph;
    test_streets::addNode(graph, 0, 0);
    test_streets::addNode(graph, 80, 0);
    test_streets::addNode(graph, 80, 80);
    test_streets::addEdge(graph, 0, 1);
    test_streets::addEdge(graph, 2, 1);
    const RoadNetwork roads = city::buildRoadNetwork(graph);
    expectSound(roads);
    EXPECT_EQ(roads.lanes.size(), 2U);
    for (const city::Connection& c : roads.connections) EXPECT_TRUE(c.conflicts.empty());
}

TEST(RoadNetwork, roundaboutGoesFirst) {
    const RoadNetwork roads = city::buildRoadNetwork(test_streets::roundabout(18, 80));
    expectSound(roads);
    int entries = 0;
    for (const city::Connection& c : roads.connections) {
        for (std::uint32_t other : c.yieldsTo) {
            const glm::vec3 p = roads.lanes[roads.connections[other].fromLane].centreLine.back();
            EXPECT_LT(std::hypot(p.x, p.y), 22.0f) << "only ways within the ring are yielded to";
            ++entries;
        }
    }
    EXPECT_GE(entries, 4);
}

TEST(RoadNetwork, tramRunsInTheMedianAndStraightOn) {
    for (float median : {7.0f, 0.0f}) {
        const RoadNetwork roads = city::buildRoadNetwork(test_streets::tramStreet(median, true));
        expectSound(roads);
        int trams = 0;
        for (const city::Lane& lane : roads.lanes) {
            if (lane.kind != city::LaneKind::tram) continue;
            ++trams;
            EXPECT_LT(std::abs(lane.centreLine.front().y), 3.0f);
        }
        EXPECT_EQ(trams, 6);
        for (const city::Junction& junction : roads.junctions) {
            if (junction.signal.phases.empty()) continue;
            int governed = 0;
            for (std::uint32_t c : junction.connections) {
                const auto& connection = roads.connections[c];
                if (roads.lanes[connection.fromLane].kind != city::LaneKind::tram) continue;
                EXPECT_NE(connection.signalGroup, city::noIndex);
                ++governed;
            }
            EXPECT_EQ(governed, 2);
        }
    }
}

TEST(RoadNetwork, crossingOfDualCarriagewaysIsOneJunction) {
    StreetGraph graph;
    // Four one-way carriageways, 12 m apart, cross in a square.
    const float d = 6;
    const std::uint32_t sw = test_streets::addNode(graph, -d, -d, true);
    const std::uint32_t se = test_streets::addNode(graph, d, -d, true);
    const std::uint32_t ne = test_streets::addNode(graph, d, d, true);
    const std::uint32_t nw = test_streets::addNode(graph, -d, d, true);
    test_streets::addEdge(graph, sw, se, 2, 0);
    test_streets::addEdge(graph, se, ne, 2, 0);
    test_streets::addEdge(graph, ne, nw, 2, 0);
    test_streets::addEdge(graph, nw, sw, 2, 0);
    const auto arm = [&](std::uint32_t node, float x, float y, bool in) {
        const std::uint32_t far = test_streets::addNode(graph, x, y);
        if (in)
            test_streets::addEdge(graph, far, node, 2, 0);
        else
            test_streets::addEdge(graph, node, far, 2, 0);
    };
    arm(sw, -100, -d, true);
    arm(se, 100, -d, false);
    arm(se, d, -100, true);
    arm(ne, d, 100, false);
    arm(ne, 100, d, true);
    arm(nw, -100, d, false);
    arm(nw, -d, 100, true);
    arm(sw, -d, -100, false);
    const RoadNetwork roads = city::buildRoadNetwork(graph);
    expectSound(roads);
    int withSignals = 0;
    for (const city::Junction& junction : roads.junctions)
        withSignals += junction.signal.phases.empty() ? 0 : 1;
    EXPECT_EQ(withSignals, 1);
    EXPECT_EQ(roads.lanes.size(), 16U);
}

TEST(RoadNetwork, survivesHostileGraphs) {
    std::mt19937_64 random(7);
    const auto draw = [&](double range) {
        return static_cast<float>(static_cast<double>(random() % 100000) * range / 100000);
    };
    for (int round = 0; round < 60; ++round) {
        StreetGraph graph;
        const int n = 3 + static_cast<int>(random() % 12);
        const double size = round % 3 == 0 ? 5 : round % 3 == 1 ? 60 : 400;
        for (int i = 0; i < n; ++i) test_streets::addNode(graph, draw(size), draw(size), random() % 3 == 0);
        if (n > 3) graph.nodes[1].position = graph.nodes[0].position;  // two nodes in one place
        for (int i = 0; i < 2 * n; ++i) {
            auto& edge =
                test_streets::addEdge(graph, static_cast<std::uint32_t>(random() % static_cast<unsigned>(n)),
                                      static_cast<std::uint32_t>(random() % static_cast<unsigned>(n)),
                                      static_cast<int>(random() % 4), static_cast<int>(random() % 4));
            edge.tram = random() % 4 == 0;
            edge.cars = random() % 6 != 0;
            edge.medianWidth = random() % 3 == 0 ? 7.0f : 0.0f;
            if (random() % 3 == 0) {
                const glm::vec3 p = edge.shape.front();
                edge.shape.insert(edge.shape.begin() + 1, {p, {draw(size), draw(size), 0}, p});
            }
            if (random() % 20 == 0) edge.shape.insert(edge.shape.begin() + 1, glm::vec3(std::nanf("")));
        }
        graph.edges.front().from = 100000;  // no such node
        const RoadNetwork roads = city::buildRoadNetwork(graph);
        ASSERT_NO_FATAL_FAILURE(expectSound(roads)) << "round " << round;
    }
    EXPECT_TRUE(city::buildRoadNetwork({}).lanes.empty());
}

TEST(RoadNetwork, sameGraphSameNetwork) {
    const StreetGraph graph = test_streets::grid(4, 80, true);
    const RoadNetwork a = city::buildRoadNetwork(graph);
    const RoadNetwork b = city::buildRoadNetwork(graph);
    ASSERT_EQ(a.connections.size(), b.connections.size());
    for (std::size_t i = 0; i < a.connections.size(); ++i)
        EXPECT_EQ(a.connections[i].centreLine, b.connections[i].centreLine);
}

}  // namespace
