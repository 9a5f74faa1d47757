#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "city/roads/RoadNetwork.h"
#include "vehicles/traffic/Traffic.h"

namespace vehicles {

/// A lane or a connection as the simulation sees it: ways 0..lanes-1 are the lanes, the connections follow.
struct Way {
    double length = 0;
    double spacing = 1;  ///< between samples, metres
    std::uint32_t firstSample = 0;
    std::uint32_t sampleCount = 2;
    bool tram = false;
    bool connection = false;
    float turn = 0;  ///< of a connection: angle, left positive
    std::uint32_t junction = city::noIndex;
    std::uint32_t signalGroup = city::noIndex;
    std::uint32_t left = city::noIndex;  ///< ways to change to
    std::uint32_t right = city::noIndex;
    std::vector<std::uint32_t> next;
    std::vector<std::uint32_t> previous;
    std::vector<std::uint32_t> yieldsTo;

    /// A stretch where this way's vehicles would touch those of another: only one of the two sides may be on
    /// it at a time.
    struct ZoneSide {
        double begin = 0;
        double end = 0;
        std::uint32_t zone = 0;
        std::uint8_t side = 0;
    };
    std::vector<ZoneSide> zones;  ///< by begin

    /// A stretch that runs along with another way in the same direction: vehicles there follow each other in
    /// file.
    struct Shared {
        double begin = 0;
        double end = 0;
        std::uint32_t other = 0;
        double otherBegin = 0;
        double scale = 1;  ///< metres of the other way for one of this
    };
    std::vector<Shared> shared;
};

/// All ways of a road network, sampled evenly, with the places where vehicles of the given kinds would touch.
struct WayNetwork {
    WayNetwork(const city::RoadNetwork& roads, std::span<const VehicleKind> kinds);

    std::vector<Way> ways;
    std::vector<glm::dvec3> samples;  ///< double: a float's steps would show in the way of a car far out
    std::vector<float> speeds;  ///< one a sample: what bends and the limit allow, braking for what follows on
                                ///< the way included
    std::uint32_t zoneCount = 0;

    glm::dvec3 pointAt(std::uint32_t way, double s) const;
    double speedAt(std::uint32_t way, double s) const;
};

/// Fills the ways' zones and shared stretches. Exact for the kinds' swept boxes up to the sampling (half a
/// metre).
void findZones(WayNetwork& network, std::span<const VehicleKind> kinds);

}  // namespace vehicles
