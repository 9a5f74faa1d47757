#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "city/roads/Polyline.h"
#include "city/roads/StreetGraph.h"

namespace city {

struct StreetLayout;

/// Box in the plan.
struct Aabb2 {
    double minX = std::numeric_limits<double>::infinity();
    double minY = std::numeric_limits<double>::infinity();
    double maxX = -std::numeric_limits<double>::infinity();
    double maxY = -std::numeric_limits<double>::infinity();

    void extend(const glm::dvec3& p) {
        minX = std::min(minX, p.x);
        minY = std::min(minY, p.y);
        maxX = std::max(maxX, p.x);
        maxY = std::max(maxY, p.y);
    }
    void extend(const Aabb2& b) {
        minX = std::min(minX, b.minX);
        minY = std::min(minY, b.minY);
        maxX = std::max(maxX, b.maxX);
        maxY = std::max(maxY, b.maxY);
    }
    double diagonal() const { return maxX < minX ? 0 : std::hypot(maxX - minX, maxY - minY); }
};

/// Edges fit to be built: finite shapes of some length, equal streets that meet at a mere bend made one.
struct CleanStreets {
    struct Edge {
        const StreetGraph::Edge* attributes = nullptr;  ///< one of the edges that it was made of
        std::uint32_t from = 0;
        std::uint32_t to = 0;
        Polyline shape;
        int lanesForward = 1;
        int lanesBackward = 1;
        std::array<bool, 2> crossing{};
    };
    std::vector<Edge> edges;
};

CleanStreets cleanStreets(const StreetGraph& graph);

/// Marks the streets of roundabouts: closed one-way ways that turn left once around within 300 m.
void markRings(StreetLayout& layout);

}  // namespace city
