#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <utility>
#include <vector>

#include "city/roads/Polyline.h"
#include "city/roads/StreetGraph.h"

namespace city {

/// Radius of the kerb at corners, metres: what a turning car with its outer lane beside it can follow.
inline constexpr double kerbRadius = 4.5;

/// A street between two junctions with its cross-section and where its lanes end: what lanes and surfaces are
/// made from, so that both agree. Offsets are metres to the right of the axis, which is the middle of the
/// carriageway.
struct Street {
    Polyline axis;  ///< corners rounded, from end 0 to end 1
    double length = 0;
    int forward = 1;   ///< car lanes along the axis
    int backward = 1;  ///< car lanes against it
    double laneWidth = 3.25;
    double median = 0;
    double pavement = 0;
    bool tram = false;
    bool cars = true;
    float speedLimit = 13.9f;
    bool ring = false;                        ///< part of a roundabout
    std::array<std::uint32_t, 2> node{};      ///< of the street graph
    std::array<std::uint32_t, 2> junction{};  ///< of the layout
    std::array<double, 2> cut{};     ///< from the end of the axis to where the junction's area begins
    std::array<double, 2> stop{};    ///< from the end of the axis to the stop line, where lanes end; >= cut
    std::array<bool, 2> crossing{};  ///< pedestrian crossing between cut and stop

    /// A strip of the cross-section that one file of vehicles follows.
    struct LaneStrip {
        double offset = 0;
        double width = 3.25;
        bool forward = true;
        bool tram = false;
        int fromKerb = 0;  ///< 0: next to the right-hand kerb of its direction
    };
    std::vector<LaneStrip> lanes;

    double halfWidth() const;          ///< of the carriageway, median included
    double medianOffset() const;       ///< middle of the free strip between the directions
    bool drivable(int fromEnd) const;  ///< whether lanes (of any kind) start at this end
};

/// Where streets meet: a node of the graph, or several that are so close that they work as one crossing.
struct StreetJunction {
    struct Arm {
        std::uint32_t street = 0;
        int end = 0;
    };
    glm::dvec3 position{0};
    bool signalled = false;
    std::vector<Arm> arms;  ///< counter-clockwise by the direction in which they leave
    std::vector<std::uint32_t> nodes;
    std::vector<std::pair<std::uint32_t, std::uint32_t>>
        inner;  ///< ways between the nodes, in driving direction

    /// Whether one may drive from one node of the junction to another inside of it.
    bool reachable(std::uint32_t fromNode, std::uint32_t toNode) const;
};

struct StreetLayout {
    std::vector<Street> streets;
    std::vector<StreetJunction> junctions;
};

/// Cleans the graph (bends become part of their street, stubs and streets without length go, crossings closer
/// together than their own size are joined) and finds where streets must end so that their carriageways do
/// not overlap.
StreetLayout layOutStreets(const StreetGraph& graph);

/// Direction in which a street leaves a junction at one of its ends, taken at the stop line.
glm::dvec3 leavingDirection(const Street& street, int end);

}  // namespace city
