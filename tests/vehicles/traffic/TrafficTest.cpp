#include "vehicles/traffic/Traffic.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <map>
#include <numbers>
#include <string>

#include "city/roads/BuildRoadNetwork.h"
#include "tests/city/roads/TestStreets.h"

namespace {

using vehicles::Traffic;
using vehicles::TrafficOptions;
using vehicles::VehicleKind;
using vehicles::VehiclePose;

std::vector<VehicleKind> fleet() {
    VehicleKind hatchback;
    hatchback.length = 4.0f;
    hatchback.width = 1.75f;
    hatchback.wheelbase = 2.5f;
    VehicleKind saloon;
    saloon.length = 4.8f;
    saloon.width = 1.85f;
    saloon.wheelbase = 2.8f;
    VehicleKind bus;
    bus.length = 12;
    bus.width = 2.55f;
    bus.wheelbase = 5.9f;
    bus.acceleration = 1.1f;
    bus.share = 0.1f;
    VehicleKind tram;
    tram.length = 27;
    tram.width = 2.4f;
    tram.wheelbase = 15;
    tram.acceleration = 1.0f;
    tram.deceleration = 1.2f;
    tram.tram = true;
    return {hatchback, saloon, bus, tram};
}

struct Box {
    glm::dvec2 centre, along, side;
    double halfLength, halfWidth;
};

Box boxOf(const VehiclePose& pose, const VehicleKind& kind) {
    const glm::dvec2 along(std::cos(pose.heading), std::sin(pose.heading));
    return {glm::dvec2(pose.position), along, {-along.y, along.x}, 0.5 * kind.length, 0.5 * kind.width};
}

/// Separating axes: exact for two rectangles.
bool overlap(const Box& a, const Box& b) {
    const glm::dvec2 d = b.centre - a.centre;
    for (const glm::dvec2& axis : {a.along, a.side, b.along, b.side}) {
        const double ra =
            a.halfLength * std::abs(glm::dot(a.along, axis)) + a.halfWidth * std::abs(glm::dot(a.side, axis));
        const double rb =
            b.halfLength * std::abs(glm::dot(b.along, axis)) + b.halfWidth * std::abs(glm::dot(b.side, axis));
        if (std::abs(glm::dot(d, axis)) >= ra + rb) return false;
    }
    return true;
}

int countOverlaps(const Traffic& traffic, const std::vector<VehicleKind>& kinds,
                  std::string* where = nullptr) {
    std::map<std::pair<long, long>, std::vector<std::uint32_t>> cells;
    const double cell = 30;
    int count = 0;
    for (std::uint32_t k = 0; k < traffic.size(); ++k) {
        const VehiclePose& pose = traffic.poses()[k];
        const long x = std::lround(pose.position.x / cell);
        const long y = std::lround(pose.position.y / cell);
        const Box box = boxOf(pose, kinds[pose.model]);
        for (long i = x - 1; i <= x + 1; ++i) {
            for (long j = y - 1; j <= y + 1; ++j) {
                const auto found = cells.find({i, j});
                if (found == cells.end()) continue;
                for (std::uint32_t other : found->second) {
                    const VehiclePose& q = traffic.poses()[other];
                    if (!overlap(box, boxOf(q, kinds[q.model]))) continue;
                    ++count;
                    if (where != nullptr && where->empty()) {
                        *where = "vehicles " + std::to_string(pose.id) + " (kind " +
                                 std::to_string(pose.model) + ") and " + std::to_string(q.id) + " (kind " +
                                 std::to_string(q.model) + ") at " + std::to_string(pose.position.x) + ", " +
                                 std::to_string(pose.position.y) + " after " +
                                 std::to_string(traffic.time()) + " s";
                    }
                }
            }
        }
        cells[{x, y}].push_back(k);
    }
    return count;
}

struct Drive {
    double metres = 0;        ///< all vehicles together
    double longestStand = 0;  ///< seconds that any vehicle stood at a stretch
    int standingAtEnd = 0;    ///< vehicles that have not moved for 150 s: longer than any cycle of signals
    int replaced = 0;         ///< vehicles that left a knot for good
    double hardest = 0;       ///< m/s^2
};

Drive drive(const city::RoadNetwork& roads, const TrafficOptions& options, double seconds,
            std::size_t atLeast) {
    const auto kinds = fleet();
    Traffic traffic(roads, kinds, options);
    EXPECT_GE(traffic.size(), atLeast);
    Drive result;
    std::vector<double> stood(traffic.size(), 0);
    std::vector<VehiclePose> before(traffic.poses().begin(), traffic.poses().end());
    std::string where;
    EXPECT_EQ(countOverlaps(traffic, kinds, &where), 0) << "at the start: " << where;
    const auto steps = static_cast<int>(seconds / options.step);
    const int every = std::max(1, static_cast<int>(0.2 / options.step));
    for (int i = 0; i < steps; ++i) {
        traffic.step();
        for (std::size_t k = 0; k < traffic.size(); ++k) {
            const VehiclePose& p = traffic.poses()[k];
            if (!std::isfinite(p.position.x + p.position.y + p.heading + p.speed + p.steering +
                               p.wheelAngle)) {
                ADD_FAILURE() << "not finite: vehicle " << k;
                return result;
            }
            if (p.id != before[k].id) {
                ++result.replaced;
                before[k] = p;
                stood[k] = 0;
                continue;
            }
            const double moved = glm::distance(p.position, before[k].position);
            // A pose never jumps: lane changes and curves included.
            EXPECT_LE(moved, 1.25 * std::max(p.speed, before[k].speed) * options.step +
                                 0.5 * 3 * options.step * options.step + 0.06);
            result.metres += moved;
            result.hardest = std::max(result.hardest, (before[k].speed - p.speed) / options.step);
            stood[k] = p.speed < 0.05f ? stood[k] + options.step : 0;
            result.longestStand = std::max(result.longestStand, stood[k]);
            before[k] = p;
        }
        if (i % every == 0) {
            where.clear();
            EXPECT_EQ(countOverlaps(traffic, kinds, &where), 0) << where;
            if (!where.empty()) return result;
        }
    }
    EXPECT_LE(result.hardest, 9.0) << "metres per second squared";
    for (double s : stood) result.standingAtEnd += s > 150 ? 1 : 0;
    std::printf(
        "%zu vehicles, %.0f s: mean speed %.2f m/s, longest stand %.0f s, stuck %d, hardest braking %.1f "
        "m/s2, replaced %d\n",
        traffic.size(), seconds,
        result.metres / static_cast<double>(std::max<std::size_t>(1, traffic.size())) / seconds,
        result.longestStand, result.standingAtEnd, result.hardest, result.replaced);
    return result;
}

TEST(Traffic, gridWithSignalsFlowsWithoutOverlap) {
    const auto roads = city::buildRoadNetwork(test_streets::grid(4, 120, true));
    TrafficOptions options;
    options.cars = 80;
    options.step = 0.05;
    const Drive result = drive(roads, options, 240, 80);
    EXPECT_GT(result.metres / 80 / 240, 3.0) << "metres per second and car";
    EXPECT_EQ(result.standingAtEnd, 0);
}

TEST(Traffic, gridWithoutSignalsFlowsWithoutOverlap) {
    const auto roads = city::buildRoadNetwork(test_streets::grid(4, 120, false));
    TrafficOptions options;
    options.cars = 80;
    options.step = 0.05;
    options.seed = 3;
    const Drive result = drive(roads, options, 240, 80);
    EXPECT_GT(result.metres / 80 / 240, 3.0);
    EXPECT_EQ(result.standingAtEnd, 0);
}

TEST(Traffic, jamKeepsMovingWithoutOverlap) {
    const auto roads = city::buildRoadNetwork(test_streets::grid(3, 100, true));
    TrafficOptions options;
    options.cars = 100000;  // as many as fit
    options.step = 0.1;
    const Drive result = drive(roads, options, 300, 150);
    EXPECT_GT(result.metres / static_cast<double>(150) / 300, 0.2);
}

TEST(Traffic, roundaboutFlowsWithoutOverlap) {
    const auto roads = city::buildRoadNetwork(test_streets::roundabout(18, 100));
    TrafficOptions options;
    options.cars = 24;
    options.step = 0.05;
    const Drive result = drive(roads, options, 300, 24);
    EXPECT_GT(result.metres / 24 / 300, 1.5);
    EXPECT_EQ(result.standingAtEnd, 0);
}

TEST(Traffic, tramsAndCarsShareTheStreetWithoutOverlap) {
    for (float median : {7.0f, 0.0f}) {
        const auto roads = city::buildRoadNetwork(test_streets::tramStreet(median, true));
        TrafficOptions options;
        options.cars = 50;
        options.trams = 4;
        options.step = 0.05;
        const Drive result = drive(roads, options, 240, 54);
        EXPECT_GT(result.metres / 54 / 240, 1.3);
        EXPECT_EQ(result.standingAtEnd, 0);
    }
}

TEST(Traffic, anyStepLengthIsSafe) {
    const auto roads = city::buildRoadNetwork(test_streets::grid(3, 100, true));
    for (double step : {0.001, 0.016, 0.3, 1.0}) {
        TrafficOptions options;
        options.cars = 60;
        options.step = step;
        drive(roads, options, step < 0.01 ? 5 : 120, 60);
    }
}

TEST(Traffic, sameSeedSameStateBitForBit) {
    const auto roads = city::buildRoadNetwork(test_streets::grid(3, 100, true));
    TrafficOptions options;
    Traffic a(roads, fleet(), options);
    Traffic b(roads, fleet(), options);
    options.seed = 2;
    Traffic c(roads, fleet(), options);
    EXPECT_NE(a.stateHash(), c.stateHash());
    const std::uint64_t start = a.stateHash();
    for (int i = 0; i < 1200; ++i) {
        a.step();
        b.step();
        c.step();
    }
    EXPECT_EQ(a.stateHash(), b.stateHash());
    EXPECT_NE(a.stateHash(), c.stateHash());
    EXPECT_NE(a.stateHash(), start);
}

TEST(Traffic, nobodyPassesARedSignal) {
    const auto graph = test_streets::grid(3, 100, true);
    const auto roads = city::buildRoadNetwork(graph);
    TrafficOptions options;
    options.cars = 60;
    options.step = 0.05;
    const auto kinds = fleet();
    Traffic traffic(roads, kinds, options);
    std::vector<glm::dvec2> before;
    int crossings = 0;
    for (int i = 0; i < 4800; ++i) {
        std::vector<glm::dvec2> now;
        for (const VehiclePose& p : traffic.poses()) {
            const Box box = boxOf(p, kinds[p.model]);
            now.push_back(box.centre + box.along * box.halfLength);
        }
        if (i > 0) {
            for (std::uint32_t c = 0; c < roads.connections.size(); ++c) {
                const city::Connection& way = roads.connections[c];
                if (way.signalGroup == city::noIndex) continue;
                // Was the stop line passed in this step, and is every way from this lane red?
                const auto& line = roads.lanes[way.fromLane].centreLine;
                const glm::dvec2 end(line.back());
                const glm::dvec2 d = glm::normalize(end - glm::dvec2(line[line.size() - 2]));
                bool anyGo = false;
                for (std::uint32_t w : roads.lanes[way.fromLane].connections) {
                    anyGo = anyGo || traffic.signal(way.junction, roads.connections[w].signalGroup) !=
                                         vehicles::SignalColour::red;
                }
                for (std::size_t k = 0; k < now.size(); ++k) {
                    const double lateral = std::abs((now[k] - end).x * d.y - (now[k] - end).y * d.x);
                    if (lateral > 1 || glm::dot(before[k] - end, d) > 0 || glm::dot(now[k] - end, d) <= 0)
                        continue;
                    if (glm::dot(now[k] - end, d) > 2) continue;
                    ++crossings;
                    EXPECT_TRUE(anyGo) << "vehicle " << k << " at " << traffic.time();
                }
            }
        }
        before = now;
        traffic.step();
    }
    EXPECT_GT(crossings, 20);
}

/// A lane around a circle, in four pieces.
city::RoadNetwork ring(double radius) {
    city::RoadNetwork roads;
    const auto arc = [&](double from, double to) {
        std::vector<glm::vec3> line;
        const int pieces = std::max(2, static_cast<int>((to - from) * 40));
        for (int i = 0; i <= pieces; ++i) {
            const double a = 2 * std::numbers::pi * (from + (to - from) * i / pieces);
            line.emplace_back(radius * std::cos(a), radius * std::sin(a), 0);
        }
        return line;
    };
    for (std::uint32_t i = 0; i < 4; ++i) {
        city::Lane lane;
        lane.centreLine = arc(0.25 * i, 0.25 * i + 0.23);
        lane.connections = {i};
        roads.lanes.push_back(lane);
        city::Connection connection;
        connection.fromLane = i;
        connection.toLane = (i + 1) % 4;
        connection.junction = i;
        connection.centreLine = arc(0.25 * i + 0.23, 0.25 * (i + 1));
        roads.connections.push_back(connection);
        city::Junction junction;
        junction.position = connection.centreLine.front();
        junction.connections = {i};
        roads.junctions.push_back(junction);
    }
    return roads;
}

TEST(Traffic, aQueueDrivesAsFastAsItsGapsAllow) {
    // The intelligent driver model in equilibrium: gap^2 (1 - (v / wanted)^4) = (1.8 m + 1.2 s v)^2; far
    // below the wanted speed, v = (gap - 1.8 m) / 1.2 s.
    constexpr double radius = 64;
    const auto roads = ring(radius);
    VehicleKind kind;
    for (const std::uint32_t cars : {30u, 36u}) {
        TrafficOptions options;
        options.cars = cars;
        options.step = 0.05;
        Traffic traffic(roads, {kind}, options);
        ASSERT_EQ(traffic.size(), cars);
        const double gap = 2 * std::numbers::pi * radius / cars - kind.length;
        double sum = 0;
        int count = 0;
        for (int i = 0; i < 6000; ++i) {
            traffic.step();
            if (i < 3000) continue;
            for (const VehiclePose& p : traffic.poses()) sum += p.speed;
            count += static_cast<int>(cars);
        }
        const double expected = (gap - 1.8) / 1.2;
        EXPECT_NEAR(sum / count, expected, 0.1 * expected) << cars;
    }
}

TEST(Traffic, lanesAreChangedOnAnAvenue) {
    city::StreetGraph graph;
    test_streets::addNode(graph, 0, 0);
    test_streets::addNode(graph, 900, 0);
    test_streets::addEdge(graph, 0, 1, 3, 3);
    const auto roads = city::buildRoadNetwork(graph);
    TrafficOptions options;
    options.cars = 60;
    options.step = 0.05;
    const auto kinds = fleet();
    Traffic traffic(roads, kinds, options);
    int changes = 0;
    std::vector<int> lane(traffic.size(), -1);
    for (int i = 0; i < 2400; ++i) {
        traffic.step();
        if (i % 4 == 0) {
            ASSERT_EQ(countOverlaps(traffic, kinds), 0);
        }
        for (std::size_t k = 0; k < traffic.size(); ++k) {
            const VehiclePose& p = traffic.poses()[k];
            if (p.position.x < 60 || p.position.x > 840) {
                lane[k] = -1;
                continue;
            }
            const int now = static_cast<int>(std::floor((p.position.y + 30) / 3.25 + 0.5));
            if (lane[k] >= 0 && lane[k] != now) ++changes;
            lane[k] = now;
        }
    }
    EXPECT_GT(changes, 5);
}

TEST(Traffic, placesOnlyWhatFitsAndNearestToTheFocus) {
    const auto roads = city::buildRoadNetwork(test_streets::grid(4, 120, true));
    TrafficOptions options;
    options.cars = 40;
    options.focus = vehicles::Focus{{120, 120, 0}, 150};
    Traffic focused(roads, fleet(), options);
    ASSERT_EQ(focused.size(), 40U);
    for (const VehiclePose& p : focused.poses())
        EXPECT_LT(glm::distance(p.position, glm::dvec3(120, 120, 0)), 152);
    options.focus.reset();
    options.cars = 1000000;
    Traffic full(roads, fleet(), options);
    EXPECT_LT(full.size(), 2000U);
    EXPECT_GT(full.size(), 300U);
}

TEST(Traffic, refusesNonsenseAndTakesNothing) {
    const city::RoadNetwork none;
    EXPECT_THROW(Traffic(none, {}, {}), std::invalid_argument);
    TrafficOptions options;
    options.step = 0;
    EXPECT_THROW(Traffic(none, fleet(), options), std::invalid_argument);
    options.step = std::nan("");
    EXPECT_THROW(Traffic(none, fleet(), options), std::invalid_argument);
    options.step = 0.1;
    Traffic empty(none, fleet(), options);
    empty.step();
    EXPECT_EQ(empty.size(), 0U);
}

}  // namespace
