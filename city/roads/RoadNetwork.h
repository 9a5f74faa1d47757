#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <string>
#include <vector>

namespace city {

/// Index that means "none".
inline constexpr std::uint32_t noIndex = std::numeric_limits<std::uint32_t>::max();

enum class LaneKind : std::uint8_t { car, tram };

/// A directed strip of road that one file of vehicles follows. Right-hand traffic.
struct Lane {
    std::vector<glm::vec3>
        centreLine;  ///< at least two points, in driving direction, no two neighbours equal; world metres
    float width = 3.25f;       ///< metres
    float speedLimit = 13.9f;  ///< metres per second
    LaneKind kind = LaneKind::car;
    std::uint32_t leftNeighbour = noIndex;  ///< lane one may change to, same direction
    std::uint32_t rightNeighbour = noIndex;
    std::vector<std::uint32_t> connections;  ///< outgoing, indices into RoadNetwork::connections
};

/// The way across a junction from the end of one lane to the start of another.
struct Connection {
    std::uint32_t fromLane = noIndex;
    std::uint32_t toLane = noIndex;
    std::uint32_t junction = noIndex;
    std::vector<glm::vec3> centreLine;    ///< from the end of fromLane to the start of toLane
    std::uint32_t signalGroup = noIndex;  ///< within the junction's signal; noIndex: not signalled
    std::vector<std::uint32_t>
        conflicts;  ///< other connections of the junction whose path crosses or merges with this one
    std::vector<std::uint32_t> yieldsTo;  ///< the part of `conflicts` that has right of way over this one
};

struct SignalPhase {
    float duration = 20;                     ///< seconds
    std::vector<std::uint32_t> greenGroups;  ///< signal groups that may go; a group not named is red
    bool amber = false;                      ///< the named groups are about to lose green: stop if possible
};

struct Signal {
    std::vector<SignalPhase> phases;  ///< repeated for ever; empty: no signal
    float offset = 0;                 ///< seconds by which this programme starts late
};

struct Junction {
    glm::vec3 position{0};
    std::vector<std::uint32_t> connections;
    Signal signal;
};

/// Where vehicles may drive. Plain data; the static map never knows the simulation.
struct RoadNetwork {
    std::vector<Lane> lanes;
    std::vector<Connection> connections;
    std::vector<Junction> junctions;
};

}  // namespace city
