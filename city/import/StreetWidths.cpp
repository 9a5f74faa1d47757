#include "city/import/StreetWidths.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <unordered_map>

#include "city/model/PolygonAlgebra.h"

namespace city {

namespace {

constexpr float narrowestLane = 2.75f;
constexpr float sampleStep = 4;
constexpr float junctionRoom = 6;     ///< metres at the ends in which corners of houses do not count
constexpr double ignoredShare = 0.1;  ///< of the samples: one oriel does not narrow a street
constexpr float cellSize = 25;        ///< no street is wider than two cells

class Walls {
  public:
    explicit Walls(const std::vector<Footprint>& buildings) : buildings_(buildings) {
        for (std::uint32_t b = 0; b < buildings.size(); ++b) {
            const auto& ring = buildings[b].outer;
            for (std::size_t i = 0; i < ring.size(); ++i) {
                const glm::vec2 from = ring[i];
                const glm::vec2 to = ring[(i + 1) % ring.size()];
                const glm::vec2 low = glm::min(from, to);
                const glm::vec2 high = glm::max(from, to);
                for (int x = cell(low.x); x <= cell(high.x); ++x)
                    for (int y = cell(low.y); y <= cell(high.y); ++y)
                        cells_[key(x, y)].push_back({from, to, b});
            }
        }
    }
    /// Distance to the nearest wall within a cell's size; -1 inside a building.
    float clearance(glm::vec2 p) const {
        float best = cellSize;
        std::uint32_t nearest = 0;
        for (int x = cell(p.x) - 1; x <= cell(p.x) + 1; ++x) {
            for (int y = cell(p.y) - 1; y <= cell(p.y) + 1; ++y) {
                const auto found = cells_.find(key(x, y));
                if (found == cells_.end()) continue;
                for (const Wall& wall : found->second) {
                    const glm::vec2 d = wall.to - wall.from;
                    const float t = std::clamp(glm::dot(p - wall.from, d) / glm::dot(d, d), 0.0f, 1.0f);
                    const float distance = glm::distance(p, wall.from + t * d);
                    if (distance >= best) continue;
                    best = distance;
                    nearest = wall.building;
                }
            }
        }
        return best < cellSize && contains(buildings_[nearest], p) ? -1 : best;
    }

  private:
    struct Wall {
        glm::vec2 from;
        glm::vec2 to;
        std::uint32_t building;
    };
    static int cell(float v) { return static_cast<int>(std::floor(v / cellSize)); }
    static std::int64_t key(int x, int y) { return static_cast<std::int64_t>(x) * 1000003 + y; }
    const std::vector<Footprint>& buildings_;
    std::unordered_map<std::int64_t, std::vector<Wall>> cells_;
};

std::vector<float> clearances(const Walls& walls, const std::vector<glm::vec3>& shape) {
    float length = 0;
    for (std::size_t i = 0; i + 1 < shape.size(); ++i) length += glm::distance(shape[i], shape[i + 1]);
    std::vector<float> found;
    float along = 0;
    float next = std::min(junctionRoom, length / 2);
    for (std::size_t i = 0; i + 1 < shape.size(); ++i) {
        const float part = glm::distance(shape[i], shape[i + 1]);
        for (; next <= along + part && next <= std::max(length - junctionRoom, length / 2);
             next += sampleStep) {
            const float t = part > 0 ? (next - along) / part : 0;
            const float clear = walls.clearance(glm::vec2(shape[i] + t * (shape[i + 1] - shape[i])));
            if (clear >= 0) found.push_back(clear);
        }
        along += part;
    }
    return found;
}

}  // namespace

std::size_t fitStreetsBetween(const std::vector<Footprint>& buildings, StreetGraph& graph, float gap) {
    const Walls walls(buildings);
    std::size_t narrowed = 0;
    for (StreetGraph::Edge& edge : graph.edges) {
        if (!edge.cars) continue;
        std::vector<float> clear = clearances(walls, edge.shape);
        if (clear.empty()) continue;
        const auto index = static_cast<std::ptrdiff_t>(ignoredShare * static_cast<double>(clear.size()));
        std::nth_element(clear.begin(), clear.begin() + index, clear.end());
        const float room = 2 * (clear[static_cast<std::size_t>(index)] - gap) - edge.medianWidth;
        const auto width = [&] {
            return static_cast<float>(edge.lanesForward + edge.lanesBackward) * edge.laneWidth;
        };
        if (width() <= room) continue;
        ++narrowed;
        // In steps, so that the pieces of one street come out alike and are joined again.
        const float fitting = room / static_cast<float>(edge.lanesForward + edge.lanesBackward);
        edge.laneWidth = std::max(narrowestLane, std::min(edge.laneWidth, std::floor(fitting * 4) / 4));
        while (width() > room && (edge.lanesForward > 1 || edge.lanesBackward > 1))
            --(edge.lanesForward > edge.lanesBackward ? edge.lanesForward : edge.lanesBackward);
    }
    return narrowed;
}

}  // namespace city
