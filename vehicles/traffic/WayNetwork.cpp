#include "vehicles/traffic/WayNetwork.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace vehicles {

namespace {

constexpr double sampleSpacing = 1.0;         // metres; finer than any curve that a vehicle can follow
constexpr double sidewaysAcceleration = 2.2;  // m/s^2; what passengers bear in town
constexpr double slowest = 1.5;               // m/s, in the tightest bend
constexpr double bendBraking = 1.5;           // m/s^2 before bends

void sampleLine(WayNetwork& network, Way& way, const std::vector<glm::vec3>& line) {
    std::vector<double> along{0};
    for (std::size_t i = 1; i < line.size(); ++i) {
        along.push_back(along.back() + glm::distance(glm::dvec3(line[i - 1]), glm::dvec3(line[i])));
    }
    way.length = std::max(1e-3, along.back());
    const auto parts = static_cast<std::uint32_t>(std::max(1.0, std::ceil(way.length / sampleSpacing)));
    way.spacing = way.length / parts;
    way.firstSample = static_cast<std::uint32_t>(network.samples.size());
    way.sampleCount = parts + 1;
    std::size_t k = 1;
    for (std::uint32_t i = 0; i <= parts; ++i) {
        const double s = i * way.spacing;
        while (k + 1 < along.size() && along[k] < s) ++k;
        const double d = along[k] - along[k - 1];
        const double t = d > 0 ? std::clamp((s - along[k - 1]) / d, 0.0, 1.0) : 0;
        network.samples.push_back((1 - t) * glm::dvec3(line[k - 1]) + t * glm::dvec3(line[k]));
    }
}

void limitSpeeds(WayNetwork& network, const Way& way, double limit) {
    const glm::dvec3* p = network.samples.data() + way.firstSample;
    const std::uint32_t n = way.sampleCount;
    std::vector<double> speed(n, limit);
    for (std::uint32_t i = 1; i + 1 < n; ++i) {
        // Turn over a few metres, so that the corners of a polyline do not count as points of no radius.
        const std::uint32_t reach = std::min({i, n - 1 - i, 3U});
        const glm::dvec3 u = p[i] - p[i - reach];
        const glm::dvec3 v = p[i + reach] - p[i];
        const double angle = std::abs(std::atan2(u.x * v.y - u.y * v.x, u.x * v.x + u.y * v.y));
        const double curvature = angle / (reach * way.spacing);
        if (curvature > 1e-4)
            speed[i] = std::min(limit, std::max(slowest, std::sqrt(sidewaysAcceleration / curvature)));
    }
    for (std::uint32_t i = n - 1; i-- > 0;) {
        speed[i] = std::min(speed[i], std::sqrt(speed[i + 1] * speed[i + 1] + 2 * bendBraking * way.spacing));
    }
    network.speeds.insert(network.speeds.end(), speed.begin(), speed.end());
}

}  // namespace

WayNetwork::WayNetwork(const city::RoadNetwork& roads, std::span<const VehicleKind> kinds) {
    const auto lanes = static_cast<std::uint32_t>(roads.lanes.size());
    ways.resize(roads.lanes.size() + roads.connections.size());
    for (std::uint32_t i = 0; i < lanes; ++i) {
        const city::Lane& lane = roads.lanes[i];
        Way& way = ways[i];
        way.tram = lane.kind == city::LaneKind::tram;
        way.left = lane.leftNeighbour;
        way.right = lane.rightNeighbour;
        for (std::uint32_t c : lane.connections) way.next.push_back(lanes + c);
        sampleLine(*this, way, lane.centreLine);
        limitSpeeds(*this, way, lane.speedLimit);
    }
    for (std::uint32_t c = 0; c < roads.connections.size(); ++c) {
        const city::Connection& connection = roads.connections[c];
        Way& way = ways[lanes + c];
        way.connection = true;
        way.tram = ways[connection.fromLane].tram;
        way.junction = connection.junction;
        way.signalGroup = connection.signalGroup;
        way.next.push_back(connection.toLane);
        way.previous.push_back(connection.fromLane);
        ways[connection.toLane].previous.push_back(lanes + c);
        for (std::uint32_t other : connection.yieldsTo) way.yieldsTo.push_back(lanes + other);
        sampleLine(*this, way, connection.centreLine);
        limitSpeeds(
            *this, way,
            std::min(roads.lanes[connection.fromLane].speedLimit, roads.lanes[connection.toLane].speedLimit));
        const auto& line = connection.centreLine;
        double turn = 0;
        for (std::size_t i = 2; i < line.size(); ++i) {
            const glm::dvec3 u(line[i - 1] - line[i - 2]);
            const glm::dvec3 v(line[i] - line[i - 1]);
            turn += std::atan2(u.x * v.y - u.y * v.x, u.x * v.x + u.y * v.y);
        }
        way.turn = static_cast<float>(turn);
    }
    findZones(*this, kinds);
}

glm::dvec3 WayNetwork::pointAt(std::uint32_t index, double s) const {
    const Way& way = ways[index];
    const double x = std::clamp(s / way.spacing, 0.0, static_cast<double>(way.sampleCount - 1));
    const auto i = std::min(static_cast<std::uint32_t>(x), way.sampleCount - 2);
    const double t = x - i;
    const glm::dvec3* p = samples.data() + way.firstSample + i;
    return (1 - t) * p[0] + t * p[1];
}

double WayNetwork::speedAt(std::uint32_t index, double s) const {
    const Way& way = ways[index];
    const double x = std::clamp(s / way.spacing, 0.0, static_cast<double>(way.sampleCount - 1));
    const auto i = std::min(static_cast<std::uint32_t>(x), way.sampleCount - 2);
    const double t = x - i;
    const float* v = speeds.data() + way.firstSample + i;
    return (1 - t) * v[0] + t * v[1];
}

}  // namespace vehicles
