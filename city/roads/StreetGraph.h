#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

namespace city {

/// Streets as a map draws them: axes between crossings. Generators and importers make this;
/// `buildRoadNetwork` turns it into lanes, connections and signals, `buildStreetSurfaces` into asphalt, kerbs
/// and markings.
struct StreetGraph {
    struct Node {
        glm::vec3 position{0};
        bool signalled = false;
    };
    struct Edge {
        std::uint32_t from = 0;
        std::uint32_t to = 0;
        std::vector<glm::vec3> shape;  ///< axis from `from` to `to`, both ends included; world metres
        int lanesForward = 1;          ///< along the shape; 0 on a one-way street the other way
        int lanesBackward = 1;
        float laneWidth = 3.25f;  ///< metres
        float medianWidth = 0;    ///< free strip between the directions (a tram bed, trees); metres
        float pavementWidth = 3;  ///< on each side; metres, 0: none
        bool tram =
            false;  ///< rails: a tram lane each way in the median, or in the inner lanes when there is none
        bool cars = true;            ///< false: a tram line of its own
        float speedLimit = 13.9f;    ///< metres per second
        bool crossingAtEnds = true;  ///< pedestrian crossings marked at both ends
        std::string name;
    };
    std::vector<Node> nodes;
    std::vector<Edge> edges;
};

}  // namespace city
