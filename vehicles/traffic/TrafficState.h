#pragma once

#include <cstdint>
#include <vector>

#include "vehicles/traffic/Traffic.h"
#include "vehicles/traffic/WayNetwork.h"

namespace vehicles {

/// SplitMix64: small, good enough for routes and paint, the same on every machine.
struct SeededRandom {
    std::uint64_t state = 0;
    std::uint64_t next();
    double unit();  ///< [0, 1)
    std::uint32_t below(std::uint32_t n);
};

/// A stretch that a vehicle has to itself until its rear has passed `end`.
struct ZoneHold {
    std::uint32_t zone = 0;
    std::uint8_t side = 0;
    double begin = 0;  ///< odometer
    double end = 0;
};

/// Why a vehicle was not granted its way.
enum class Refusal : std::uint8_t { none, signal, taken, noRoom, claimed, yields };

/// One vehicle. All places along its way are odometer readings: metres driven by its front since it was
/// placed, so a way, a zone and a stop line are intervals and points of one axis.
struct Vehicle {
    std::uint32_t id = 0;
    std::uint32_t kind = 0;
    double front = 0;
    double speed = 0;
    double acceleration = 0;
    double length = 4.5;

    std::vector<std::uint32_t> path;  ///< ways from the one under the rear to as far as is planned
    std::vector<double>
        starts;                 ///< odometer at the start of each way of the path, and at the end of the last
    std::uint32_t current = 0;  ///< index into path of the way under the front

    std::vector<ZoneHold> holds;
    double granted = 0;               ///< all zones that begin before this are held
    double nextStop = 0;              ///< where it must stop unless more is granted
    bool stopIsPlan = false;          ///< nothing stops it there: only the plan ends
    double stood = 0;                 ///< seconds without motion
    double waited = 0;                ///< seconds in front of a stop
    Refusal refusal = Refusal::none;  ///< why it was not granted more the last time

    // A lane change: until `changeEnd` the vehicle counts in both lanes.
    std::uint32_t changeFrom = city::noIndex;
    double changeStart = 0;
    double changeLength = 1;
    double changeScale = 1;  ///< metres of the old lane for one of the new

    SeededRandom random;
    double temper = 1;  ///< of the speed limit, what this driver drives
    double wheelAngle = 0;
    std::uint32_t entry = 0;

    double rear() const { return front - length; }
    double way(std::size_t i) const { return starts[i + 1] - starts[i]; }
};

struct Leader {
    double gap = 1e9;  ///< metres from this front to that rear
    double speed = 0;
    std::uint32_t vehicle = city::noIndex;
};

struct Traffic::State {
    State(const city::RoadNetwork& network, std::vector<VehicleKind> vehicleKinds,
          const TrafficOptions& wanted);

    // Placement.cpp
    void place();
    void relocate(std::uint32_t index);
    bool tryPlace(std::uint32_t kind, std::uint32_t way, double s);

    // Traffic.cpp
    void stepOnce(double dt);
    void listVehicles();
    void move(double dt);
    void updatePoses();
    SignalColour colour(std::uint32_t junction, std::uint32_t group) const;

    // Routes.cpp
    void extend(Vehicle& v, double odometer);
    void shorten(Vehicle& v);
    void dropPassed(Vehicle& v);

    // Following.cpp
    Leader leaderOf(const Vehicle& v, std::uint32_t index, double reach) const;
    double freeSpeed(const Vehicle& v) const;
    double follow(const Vehicle& v, double wanted, double gap, double leaderSpeed) const;
    bool changeLanes(std::uint32_t index);

    // Grants.cpp
    void findNextStop(Vehicle& v);
    void askForWay(std::uint32_t index, double dt);
    bool grant(std::uint32_t index);
    void reconsider(Vehicle& v);
    bool mustYield(const Vehicle& v, std::uint32_t index, std::size_t pathIndex, double clearDistance) const;
    bool roomBehind(const Vehicle& v, std::uint32_t index, double groupEnd) const;
    void release(Vehicle& v);

    const city::RoadNetwork* roads;
    std::vector<VehicleKind> kinds;
    TrafficOptions options;
    WayNetwork net;
    std::vector<Vehicle> vehicles;
    std::vector<VehiclePose> poses;
    std::uint32_t nextId = 0;
    SeededRandom relocation;  ///< where vehicles that leave for good come back
    std::uint64_t steps = 0;
    std::uint64_t substeps = 0;
    double time = 0;

    struct Entry {
        double front = 0;  ///< in the way's own metres; may lie beyond its end
        std::uint32_t vehicle = 0;
        bool ghost = false;  ///< counted in the lane that it is leaving
    };
    std::vector<std::uint32_t> listStart;  ///< one a way, and the end
    std::vector<Entry> entries;            ///< by way, then by front
    std::vector<std::uint32_t> fill;
    std::vector<std::vector<std::uint32_t>> placed;  ///< while placing: vehicles by lane
    std::vector<std::uint32_t> order;                ///< vehicles, foremost first on each way

    struct ZoneState {
        std::uint16_t holders[2] = {0, 0};
        std::uint64_t claimed = 0;  ///< substep of the last claim by a vehicle that has waited long
        double claimWait = 0;
        std::uint8_t claimSide = 0;
    };
    std::vector<ZoneState> zones;

    std::vector<std::uint32_t> phase;      ///< one a junction
    std::vector<std::uint64_t> changedAt;  ///< one a way: substep of the last lane change into or out of it
    std::vector<double> newFront;
    std::vector<double> newSpeed;
};

/// Kept between bumpers whatever happens, metres.
inline constexpr double bumperGap = 0.6;
/// Free space that a vehicle leaves around itself where it stands behind a crossing.
inline constexpr double standingGap = 2.0;
/// The hardest that anything brakes, m/s^2.
inline constexpr double hardestBraking = 8.0;

}  // namespace vehicles
