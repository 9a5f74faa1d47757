#pragma once

#include <cmath>
#include <cstdint>
#include <glm/vec3.hpp>
#include <numbers>
#include <utility>
#include <vector>

#include "city/roads/StreetGraph.h"

/// Small street graphs that tests of roads and traffic share.
namespace test_streets {

inline std::uint32_t addNode(city::StreetGraph& graph, float x, float y, bool signalled = false) {
    graph.nodes.push_back({{x, y, 0}, signalled});
    return static_cast<std::uint32_t>(graph.nodes.size() - 1);
}

inline city::StreetGraph::Edge& addEdge(city::StreetGraph& graph, std::uint32_t from, std::uint32_t to,
                                        int forward = 1, int backward = 1) {
    city::StreetGraph::Edge edge;
    edge.from = from;
    edge.to = to;
    edge.shape = {graph.nodes[from].position, graph.nodes[to].position};
    edge.lanesForward = forward;
    edge.lanesBackward = backward;
    graph.edges.push_back(edge);
    return graph.edges.back();
}

/// n x n nodes, streets between neighbours; the middle row is an avenue with two lanes each way.
inline city::StreetGraph grid(int n, float spacing, bool signals, bool avenue = true) {
    city::StreetGraph graph;
    const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(j * n + i); };
    for (int j = 0; j < n; ++j) {
        for (int i = 0; i < n; ++i) {
            const bool inner = i > 0 && j > 0 && i < n - 1 && j < n - 1;
            addNode(graph, static_cast<float>(i) * spacing, static_cast<float>(j) * spacing,
                    signals && inner);
        }
    }
    for (int j = 0; j < n; ++j) {
        for (int i = 0; i < n; ++i) {
            const int across = avenue && j == n / 2 ? 2 : 1;
            if (i + 1 < n) addEdge(graph, at(i, j), at(i + 1, j), across, across);
            if (j + 1 < n) addEdge(graph, at(i, j), at(i, j + 1));
        }
    }
    return graph;
}

/// A one-way ring with four streets that end in dead ends.
inline city::StreetGraph roundabout(float radius, float armLength) {
    city::StreetGraph graph;
    for (int k = 0; k < 4; ++k) {
        const double a = k * std::numbers::pi / 2;
        addNode(graph, radius * static_cast<float>(std::cos(a)), radius * static_cast<float>(std::sin(a)));
    }
    for (std::uint32_t k = 0; k < 4; ++k) {
        city::StreetGraph::Edge& edge = addEdge(graph, k, (k + 1) % 4, 1, 0);
        edge.shape.clear();
        for (int i = 0; i <= 8; ++i) {
            const double a = (k + i / 8.0) * std::numbers::pi / 2;
            edge.shape.emplace_back(radius * std::cos(a), radius * std::sin(a), 0);
        }
    }
    for (std::uint32_t k = 0; k < 4; ++k) {
        const glm::vec3 p = graph.nodes[k].position;
        const glm::vec3 q = p * ((radius + armLength) / radius);
        addEdge(graph, k, addNode(graph, q.x, q.y));
    }
    return graph;
}

/// A street with a tram in its median that crosses two side streets; all ends are dead ends.
inline city::StreetGraph tramStreet(float median, bool signals) {
    city::StreetGraph graph;
    for (int i = 0; i < 4; ++i)
        addNode(graph, 120.0f * static_cast<float>(i), 0, signals && (i == 1 || i == 2));
    for (std::uint32_t i = 0; i < 3; ++i) {
        city::StreetGraph::Edge& edge = addEdge(graph, i, i + 1, 2, 2);
        edge.medianWidth = median;
        edge.tram = true;
    }
    for (std::uint32_t i : {1U, 2U}) {
        for (float side : {-1.0f, 1.0f}) {
            addEdge(graph, i, addNode(graph, 120.0f * static_cast<float>(i), side * 120));
        }
    }
    return graph;
}

}  // namespace test_streets
