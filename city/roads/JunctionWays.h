#pragma once

#include <cstdint>
#include <vector>

#include "city/roads/RoadNetwork.h"
#include "city/roads/StreetLayout.h"

namespace city {

/// A lane together with where it comes from.
struct LaneOrigin {
    std::uint32_t street = 0;
    bool forward = true;
    int fromKerb = 0;
    int count = 1;  ///< lanes of this kind in this direction
};

/// What is known of a network while it is built.
struct NetworkDraft {
    const StreetLayout* layout = nullptr;
    RoadNetwork roads;
    std::vector<LaneOrigin> origins;                        ///< one a lane
    std::vector<std::vector<std::uint32_t>> lanesOfStreet;  ///< in the order of Street::lanes
};

/// A lane that ends at a junction, or starts there.
struct LaneEnd {
    std::uint32_t lane = 0;
    std::uint32_t arm = 0;  ///< index into StreetJunction::arms
};
std::vector<LaneEnd> lanesInto(const NetworkDraft& draft, std::uint32_t junction);
std::vector<LaneEnd> lanesOutOf(const NetworkDraft& draft, std::uint32_t junction);

/// Direction at the last (first) point of a lane, unit, in the plan.
glm::dvec3 endDirection(const std::vector<glm::vec3>& line);
glm::dvec3 startDirection(const std::vector<glm::vec3>& line);

/// Adds a connection (centre line, back references).
void connect(NetworkDraft& draft, std::uint32_t junction, std::uint32_t from, std::uint32_t to,
             const Polyline& line);

/// Adds the way from the end of a lane back into another one beside it; false if there is one already.
bool turnBack(NetworkDraft& draft, std::uint32_t from, std::uint32_t to);

/// The ways across each junction: turns by lane, tram ways, turning bulbs at dead ends, links between the
/// loose ends of one-way streets.
void connectJunctions(NetworkDraft& draft);

/// Conflicts by geometry, and who goes first.
void findConflicts(NetworkDraft& draft);

/// Signal groups and programmes of signalled junctions; with them, only ways that are green together yield to
/// each other.
void planSignals(NetworkDraft& draft, const std::vector<bool>& signalled);

/// Angle of a connection's turn, left positive.
double turnOf(const Connection& connection);

}  // namespace city
