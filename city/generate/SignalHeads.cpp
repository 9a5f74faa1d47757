#include "city/generate/SignalHeads.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <set>

namespace city {

namespace {

constexpr float medianOffset = 0.35f;  // metres from a tram lane's edge: there is no more room in a median
constexpr float medianSetBack = 3;     // metres before the stop line: clear of trams that turn right

}  // namespace

SignalLayout layOutSignals(const RoadNetwork& roads, float kerbOffset, float height) {
    SignalLayout layout;
    for (const Lane& lane : roads.lanes) {
        // One pole an approach: at its rightmost lane.
        if (lane.centreLine.size() < 2 || lane.rightNeighbour != noIndex) continue;
        std::set<std::pair<std::uint32_t, std::uint32_t>> groups;  // junction, group
        const Lane* member = &lane;
        // Bounded by the number of lanes: a damaged network may name neighbours in a circle.
        for (std::size_t step = 0; step < roads.lanes.size(); ++step) {
            for (const std::uint32_t c : member->connections) {
                const Connection& connection = roads.connections[c];
                if (connection.signalGroup != noIndex && connection.junction != noIndex) {
                    groups.insert({connection.junction, connection.signalGroup});
                }
            }
            if (member->leftNeighbour == noIndex) break;
            member = &roads.lanes[member->leftNeighbour];
        }
        if (groups.empty()) continue;
        const glm::vec3 end = lane.centreLine.back();
        const glm::vec3 way = end - lane.centreLine[lane.centreLine.size() - 2];
        const float length = glm::length(glm::vec2(way.x, way.y));
        if (!(length > 0)) continue;
        const glm::vec3 along(way.x / length, way.y / length, 0), right(along.y, -along.x, 0);
        const bool tram = lane.kind == LaneKind::tram;
        SignalPole pole{end + (0.5f * lane.width + (tram ? medianOffset : kerbOffset)) * right, -along};
        if (tram) pole.foot -= medianSetBack * along;
        float aside = 0;
        for (const auto& [junction, group] : groups) {
            SignalHead head;
            head.position = pole.foot - along * 0.18f + right * aside + glm::vec3(0, 0, height);
            head.facing = -along;
            head.junction = junction;
            head.signalGroup = group;
            layout.heads.push_back(head);
            aside += 0.4f;
        }
        layout.poles.push_back(pole);
    }
    return layout;
}

}  // namespace city
