#include "city/roads/BuildRoadNetwork.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "city/roads/JunctionWays.h"
#include "city/roads/StreetLayout.h"

namespace city {

namespace {

/// Where lanes hold no more than this between points they are straight enough for float chords.
constexpr double longestChord = 25.0;

std::vector<glm::vec3> asFloats(const Polyline& line) {
    std::vector<glm::vec3> out;
    for (std::size_t i = 0; i < line.size(); ++i) {
        if (i > 0) {
            const int parts = static_cast<int>(std::ceil(glm::distance(line[i - 1], line[i]) / longestChord));
            for (int k = 1; k < parts; ++k) {
                out.emplace_back(glm::mix(line[i - 1], line[i], static_cast<double>(k) / parts));
            }
        }
        const glm::vec3 p(line[i]);
        if (out.empty() || p != out.back()) out.push_back(p);
    }
    return out;
}

void makeLanes(NetworkDraft& draft) {
    for (std::uint32_t s = 0; s < draft.layout->streets.size(); ++s) {
        const Street& street = draft.layout->streets[s];
        const Polyline axis = partOf(street.axis, street.stop[0], street.length - street.stop[1]);
        std::vector<std::uint32_t> mine;
        for (const Street::LaneStrip& strip : street.lanes) {
            Polyline line = offsetToTheRight(axis, strip.offset);
            if (!strip.forward) line = reversed(std::move(line));
            Lane lane;
            lane.centreLine = asFloats(line);
            lane.width = static_cast<float>(strip.width);
            lane.speedLimit = street.speedLimit;
            lane.kind = strip.tram ? LaneKind::tram : LaneKind::car;
            if (lane.centreLine.size() < 2) {
                // Far from the origin two points may fall on one float; a lane must still lead somewhere.
                const glm::vec3 p = lane.centreLine.empty() ? glm::vec3(0) : lane.centreLine.front();
                lane.centreLine = {p, p + glm::vec3(directionAt(line, 0))};
            }
            mine.push_back(static_cast<std::uint32_t>(draft.roads.lanes.size()));
            draft.roads.lanes.push_back(std::move(lane));
            draft.origins.push_back({s, strip.forward, strip.fromKerb, 1});
        }
        for (std::size_t i = 0; i < mine.size(); ++i) {
            const Street::LaneStrip& a = street.lanes[i];
            int count = 0;
            for (std::size_t j = 0; j < mine.size(); ++j) {
                const Street::LaneStrip& b = street.lanes[j];
                if (a.tram != b.tram || a.forward != b.forward) continue;
                ++count;
                if (a.tram) continue;
                if (b.fromKerb == a.fromKerb + 1) draft.roads.lanes[mine[i]].leftNeighbour = mine[j];
                if (b.fromKerb == a.fromKerb - 1) draft.roads.lanes[mine[i]].rightNeighbour = mine[j];
            }
            draft.origins[mine[i]].count = count;
        }
        draft.lanesOfStreet.push_back(std::move(mine));
    }
}

/// The innermost lane of the same kind and street the other way.
std::uint32_t oppositeLane(const NetworkDraft& draft, std::uint32_t lane) {
    const LaneOrigin& origin = draft.origins[lane];
    std::uint32_t best = noIndex;
    for (std::uint32_t other : draft.lanesOfStreet[origin.street]) {
        if (draft.origins[other].forward == origin.forward ||
            draft.roads.lanes[other].kind != draft.roads.lanes[lane].kind)
            continue;
        if (best == noIndex || draft.origins[other].fromKerb > draft.origins[best].fromKerb) best = other;
    }
    return best;
}

/// Takes out lanes that lead nowhere (and, in turn, those that lead only to them).
void pruneBlindLanes(NetworkDraft& draft) {
    RoadNetwork& roads = draft.roads;
    std::vector<bool> dead(roads.lanes.size(), false);
    bool changed = true;
    while (changed) {
        changed = false;
        for (std::uint32_t i = 0; i < roads.lanes.size(); ++i) {
            if (dead[i]) continue;
            const auto& ways = roads.lanes[i].connections;
            const bool leadsOn = std::any_of(ways.begin(), ways.end(), [&](std::uint32_t c) {
                return !dead[roads.connections[c].toLane];
            });
            if (leadsOn) continue;
            // A two-way street turns back rather than die with what it leads to.
            const std::uint32_t back = oppositeLane(draft, i);
            if (back != noIndex && !dead[back] && turnBack(draft, i, back)) continue;
            dead[i] = true;
            changed = true;
        }
    }
    std::vector<std::uint32_t> laneIndex(roads.lanes.size(), noIndex);
    std::vector<std::uint32_t> wayIndex(roads.connections.size(), noIndex);
    std::uint32_t lanes = 0;
    std::uint32_t ways = 0;
    for (std::uint32_t i = 0; i < laneIndex.size(); ++i) {
        if (!dead[i]) laneIndex[i] = lanes++;
    }
    for (std::uint32_t i = 0; i < wayIndex.size(); ++i) {
        const Connection& c = roads.connections[i];
        if (!dead[c.fromLane] && !dead[c.toLane]) wayIndex[i] = ways++;
    }
    const auto keepMapped = [](std::vector<std::uint32_t>& list, const std::vector<std::uint32_t>& map) {
        std::vector<std::uint32_t> kept;
        for (std::uint32_t i : list) {
            if (map[i] != noIndex) kept.push_back(map[i]);
        }
        list = std::move(kept);
    };
    for (std::uint32_t i = 0; i < laneIndex.size(); ++i) {
        if (laneIndex[i] == noIndex) continue;
        Lane& lane = roads.lanes[i];
        keepMapped(lane.connections, wayIndex);
        if (lane.leftNeighbour != noIndex) lane.leftNeighbour = laneIndex[lane.leftNeighbour];
        if (lane.rightNeighbour != noIndex) lane.rightNeighbour = laneIndex[lane.rightNeighbour];
        if (laneIndex[i] != i) {
            roads.lanes[laneIndex[i]] = std::move(lane);
            draft.origins[laneIndex[i]] = draft.origins[i];
        }
    }
    roads.lanes.resize(lanes);
    draft.origins.resize(lanes);
    for (std::uint32_t i = 0; i < wayIndex.size(); ++i) {
        if (wayIndex[i] == noIndex) continue;
        Connection& c = roads.connections[i];
        c.fromLane = laneIndex[c.fromLane];
        c.toLane = laneIndex[c.toLane];
        if (wayIndex[i] != i) roads.connections[wayIndex[i]] = std::move(c);
    }
    roads.connections.resize(ways);
    for (Junction& junction : roads.junctions) keepMapped(junction.connections, wayIndex);
    for (auto& list : draft.lanesOfStreet) keepMapped(list, laneIndex);
}

}  // namespace

RoadNetwork buildRoadNetwork(const StreetGraph& streets) {
    const StreetLayout layout = layOutStreets(streets);
    NetworkDraft draft;
    draft.layout = &layout;
    makeLanes(draft);
    std::vector<bool> signalled;
    for (const StreetJunction& junction : layout.junctions) {
        draft.roads.junctions.emplace_back();
        draft.roads.junctions.back().position = glm::vec3(junction.position);
        signalled.push_back(junction.signalled);
    }
    connectJunctions(draft);
    pruneBlindLanes(draft);
    findConflicts(draft);
    planSignals(draft, signalled);
    return std::move(draft.roads);
}

}  // namespace city
