#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "city/roads/JunctionWays.h"

namespace city {

namespace {

constexpr double carPath = 2.1;  // metres that a car and its swing take up
constexpr double tramPath = 2.8;
constexpr double elbowRoom = 0.2;  // between two vehicles that pass each other
constexpr double opposing = 2.35;  // radians between directions of approaches that face each other

struct Approach {
    glm::dvec3 direction;
    double rank = 0;
    double turn = 0;
    bool tram = false;
    bool ring = false;
    std::uint32_t street = 0;
    int fromKerb = 0;
};

bool pathsMeet(const Connection& a, const Connection& b, double reach) {
    for (const glm::vec3& p : a.centreLine) {
        for (std::size_t i = 1; i < b.centreLine.size(); ++i) {
            const glm::vec3 u = b.centreLine[i - 1];
            const glm::vec3 d = b.centreLine[i] - u;
            const float l2 = d.x * d.x + d.y * d.y;
            const float t =
                l2 > 0 ? std::clamp(((p.x - u.x) * d.x + (p.y - u.y) * d.y) / l2, 0.0f, 1.0f) : 0.0f;
            if (std::hypot(p.x - u.x - t * d.x, p.y - u.y - t * d.y) < reach) return true;
        }
    }
    return false;
}

/// Whether b goes before a.
bool hasRightOfWay(const Approach& b, const Approach& a) {
    if (a.ring != b.ring) return b.ring;
    if (a.rank > 1.15 * b.rank) return false;
    if (b.rank > 1.15 * a.rank) return true;
    if (a.tram != b.tram) return b.tram;
    const double angle = turnAngle(a.direction, b.direction);
    if (a.street == b.street && std::abs(angle) < 0.5) return b.fromKerb < a.fromKerb;
    if (std::abs(angle) > opposing) {
        // Facing each other: whoever turns left, or back, waits.
        return a.turn > 0.5 && a.turn > b.turn + 0.3;
    }
    // Right before left: b comes from the right if its direction points to a's left.
    return angle > 0;
}

}  // namespace

void findConflicts(NetworkDraft& draft) {
    RoadNetwork& roads = draft.roads;
    std::vector<Approach> approach(roads.connections.size());
    for (std::size_t c = 0; c < approach.size(); ++c) {
        const Connection& connection = roads.connections[c];
        const LaneOrigin& origin = draft.origins[connection.fromLane];
        const Street& street = draft.layout->streets[origin.street];
        Approach& a = approach[c];
        a.direction = endDirection(roads.lanes[connection.fromLane].centreLine);
        // Bigger street first: by speed, then by lanes (four lanes weigh as much as a third more of speed).
        a.rank = street.speedLimit * (1 + 0.17 * (std::max(street.forward, street.backward) - 1));
        a.turn = turnOf(connection);
        a.tram = roads.lanes[connection.fromLane].kind == LaneKind::tram;
        a.ring = street.ring;
        a.street = origin.street;
        a.fromKerb = origin.fromKerb;
    }
    for (const Junction& junction : roads.junctions) {
        const auto& ways = junction.connections;
        for (std::size_t i = 0; i < ways.size(); ++i) {
            for (std::size_t k = i + 1; k < ways.size(); ++k) {
                Connection& a = roads.connections[ways[i]];
                Connection& b = roads.connections[ways[k]];
                if (a.fromLane == b.fromLane) continue;
                const auto path = [&](std::uint32_t c) { return approach[c].tram ? tramPath : carPath; };
                const double reach = 0.5 * (path(ways[i]) + path(ways[k])) + elbowRoom;
                if (a.toLane != b.toLane && !pathsMeet(a, b, reach) && !pathsMeet(b, a, reach)) continue;
                a.conflicts.push_back(ways[k]);
                b.conflicts.push_back(ways[i]);
                const bool bFirst = hasRightOfWay(approach[ways[k]], approach[ways[i]]);
                const bool aFirst = hasRightOfWay(approach[ways[i]], approach[ways[k]]);
                if (bFirst && !aFirst) a.yieldsTo.push_back(ways[k]);
                if (aFirst && !bFirst) b.yieldsTo.push_back(ways[i]);
            }
        }
    }
}

}  // namespace city
