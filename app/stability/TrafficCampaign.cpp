// Traffic: steps of 1 ms to 1 s, lanes without length, 10,000 cars in a jam.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <string>
#include <unordered_map>
#include <vector>

#include "app/stability/Stability.h"
#include "city/roads/BuildRoadNetwork.h"
#include "vehicles/traffic/Traffic.h"

namespace app::stability {

namespace {

using vehicles::Traffic;
using vehicles::TrafficOptions;
using vehicles::VehicleKind;
using vehicles::VehiclePose;

std::vector<VehicleKind> kinds() {
    VehicleKind car, bus;
    bus.length = 12;
    bus.width = 2.55f;
    bus.wheelbase = 5.9f;
    bus.acceleration = 1.1f;
    bus.share = 0.05f;
    return {car, bus};
}

/// n x n crossings, streets between neighbours, signals at every other one.
city::RoadNetwork grid(int n, float spacing) {
    city::StreetGraph graph;
    const auto at = [n](int i, int j) { return static_cast<std::uint32_t>(j * n + i); };
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i)
            graph.nodes.push_back({{static_cast<float>(i) * spacing, static_cast<float>(j) * spacing, 0},
                                   (i + j) % 2 == 0 && i > 0 && j > 0 && i < n - 1 && j < n - 1});
    const auto join = [&](std::uint32_t from, std::uint32_t to) {
        city::StreetGraph::Edge edge;
        edge.from = from;
        edge.to = to;
        edge.shape = {graph.nodes[from].position, graph.nodes[to].position};
        graph.edges.push_back(edge);
    };
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            if (i + 1 < n) join(at(i, j), at(i + 1, j));
            if (j + 1 < n) join(at(i, j), at(i, j + 1));
        }
    return city::buildRoadNetwork(graph);
}

/// A ring of four straight lanes, joined by lanes and connections that have no length at all.
city::RoadNetwork ringWithLanesWithoutLength() {
    city::RoadNetwork roads;
    const glm::vec3 corners[] = {{0, 0, 0}, {150, 0, 0}, {150, 150, 0}, {0, 150, 0}};
    for (int k = 0; k < 4; ++k) {
        const glm::vec3 from = corners[k], to = corners[(k + 1) % 4];
        city::Lane straight, nothing;
        straight.centreLine = {from, to};
        nothing.centreLine = {to, to};
        roads.lanes.push_back(straight);
        roads.lanes.push_back(nothing);
    }
    for (std::uint32_t lane = 0; lane < 8; ++lane) {
        city::Connection way;
        way.fromLane = lane;
        way.toLane = (lane + 1) % 8;
        way.junction = static_cast<std::uint32_t>(roads.junctions.size());
        const glm::vec3 end = roads.lanes[lane].centreLine.back();
        way.centreLine = {end, end};
        roads.lanes[lane].connections.push_back(static_cast<std::uint32_t>(roads.connections.size()));
        city::Junction junction;
        junction.position = end;
        junction.connections.push_back(static_cast<std::uint32_t>(roads.connections.size()));
        roads.connections.push_back(way);
        roads.junctions.push_back(junction);
    }
    return roads;
}

struct Box {
    glm::dvec2 centre{0}, along{1, 0};
    double halfLength = 0, halfWidth = 0;
    glm::dvec2 side() const { return {-along.y, along.x}; }
};

/// Separating axes: exact for two rectangles, but for a rounding of 1e-9 m.
bool overlap(const Box& a, const Box& b) {
    const glm::dvec2 d = b.centre - a.centre;
    for (const glm::dvec2& axis : {a.along, a.side(), b.along, b.side()}) {
        double reach = 0;
        for (const Box* box : {&a, &b})
            reach += box->halfLength * std::abs(glm::dot(box->along, axis)) +
                     box->halfWidth * std::abs(glm::dot(box->side(), axis));
        if (std::abs(glm::dot(d, axis)) >= reach - 1e-9) return false;
    }
    return true;
}

std::uint64_t countOverlaps(const Traffic& traffic, const std::vector<VehicleKind>& fleet) {
    constexpr double cell = 15;  // more than a bus is long
    std::unordered_map<std::uint64_t, std::vector<Box>> cells;
    const auto key = [](long i, long j) {
        return (static_cast<std::uint64_t>(i) << 32) ^ (static_cast<std::uint64_t>(j) & 0xffffffffu);
    };
    std::uint64_t count = 0;
    for (const VehiclePose& pose : traffic.poses()) {
        const VehicleKind& kind = fleet[pose.model];
        const Box box{glm::dvec2(pose.position),
                      {std::cos(pose.heading), std::sin(pose.heading)},
                      0.5 * static_cast<double>(kind.length),
                      0.5 * static_cast<double>(kind.width)};
        const long x = std::lround(box.centre.x / cell), y = std::lround(box.centre.y / cell);
        for (long i = x - 1; i <= x + 1; ++i)
            for (long j = y - 1; j <= y + 1; ++j)
                if (const auto found = cells.find(key(i, j)); found != cells.end())
                    for (const Box& other : found->second) count += overlap(box, other) ? 1 : 0;
        cells[key(x, y)].push_back(box);
    }
    return count;
}

bool isFinite(const VehiclePose& p) {
    return std::isfinite(p.position.x + p.position.y + p.position.z + p.heading + p.pitch) &&
           std::isfinite(p.speed + p.wheelAngle + p.steering);
}

std::vector<Row> drive(const std::string& what, const city::RoadNetwork& roads,
                       const TrafficOptions& settings, double seconds, std::size_t atLeast,
                       const Options& options) {
    Row overlaps{
        "traffic", what + ": overlaps", 0, 0, 0, 0, "pairs of boxes", "Traffic.h: boxes do not overlap", ""};
    Row finite{"traffic", what + ": not a number", 0, 0, 0, 0, "poses", "every pose is finite", ""};
    Row teleports{"traffic",
                  what + ": the way of a step",
                  0,
                  0,
                  0,
                  1,
                  "of what may be",
                  "speed, 3 m/s^2, a quarter more in lane changes and bends, 6 cm of settling",
                  ""};
    const std::vector<VehicleKind> fleet = kinds();
    Traffic traffic(roads, fleet, settings);
    if (traffic.size() < atLeast) {
        ++overlaps.failures;
        overlaps.example = "only " + std::to_string(traffic.size()) + " vehicles found a place";
    }
    std::vector<VehiclePose> before(traffic.poses().begin(), traffic.poses().end());
    const auto steps = static_cast<int>(seconds / settings.step);
    const int every = std::max(1, static_cast<int>(0.5 / settings.step));
    for (int step = 0; step < steps && !options.stop(); ++step) {
        traffic.step();
        for (std::size_t k = 0; k < traffic.size(); ++k) {
            const VehiclePose& pose = traffic.poses()[k];
            ++finite.tried;
            finite.failures += isFinite(pose) ? 0 : 1;
            // One that left a knot for good has another id.
            if (pose.id == before[k].id) {
                const double speed = static_cast<double>(std::max(pose.speed, before[k].speed));
                const double allowed =
                    1.25 * speed * settings.step + 0.5 * 3 * settings.step * settings.step + 0.06;
                const double share = glm::distance(pose.position, before[k].position) / allowed;
                ++teleports.tried;
                teleports.worst = std::max(teleports.worst, share);
                teleports.failures += !(share <= 1) ? 1 : 0;
            }
            before[k] = pose;
        }
        if (step % every != 0) continue;
        overlaps.tried += traffic.size();
        overlaps.failures += countOverlaps(traffic, fleet);
    }
    overlaps.worst = static_cast<double>(overlaps.failures);
    finite.worst = static_cast<double>(finite.failures);
    return {overlaps, finite, teleports};
}

}  // namespace

std::vector<Row> tryTraffic(const Options& options) {
    std::vector<Row> rows;
    const auto append = [&](const std::vector<Row>& more, double share) {
        rows.insert(rows.end(), more.begin(), more.end());
        options.tell(share);
    };
    const double longer = std::min(options.effort(), 20);
    const city::RoadNetwork town = grid(4, 110);
    TrafficOptions settings;
    settings.seed = options.seed;
    settings.cars = 80;
    struct Step {
        const char* name;
        double seconds, simulated;
    };
    for (const Step& step : {Step{"steps of 1 ms", 0.001, 4},
                             {"steps of 1/60 s", 1.0 / 60, 60},
                             {"steps of 0.3 s", 0.3, 240},
                             {"steps of 1 s", 1, 300}}) {
        settings.step = step.seconds;
        append(drive(step.name, town, settings, step.simulated * longer, 80, options), 0.1);
    }
    settings.step = 0.05;
    settings.cars = 40;
    append(drive("lanes without length", ringWithLanesWithoutLength(), settings, 120 * longer, 20, options),
           0.3);
    settings.step = 0.1;
    settings.cars = 10'000;
    append(drive("10,000 cars in a jam", grid(18, 120), settings, 15 * longer, 10'000, options), 1);
    return rows;
}

}  // namespace app::stability
