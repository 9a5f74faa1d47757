#include "city/model/LaneClearance.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <span>

namespace city {

namespace {

/// First and last cell of one axis whose centres lie in [low, high]; coordinates in cells from the grid's
/// corner.
struct Cells {
    int first, last;
};

Cells centresIn(double low, double high, int count) {
    return {static_cast<int>(std::clamp(std::ceil(low - 0.5), 0.0, static_cast<double>(count))),
            static_cast<int>(std::clamp(std::floor(high - 0.5), -1.0, count - 1.0))};
}

void clearSegment(const glm::dvec2& a, const glm::dvec2& b, double reach, Heightfield& field) {
    const double cell = field.cellSize();
    const glm::dvec2 low = (glm::min(a, b) - reach - field.origin()) / cell;
    const glm::dvec2 high = (glm::max(a, b) + reach - field.origin()) / cell;
    if (!std::isfinite(low.x + low.y + high.x + high.y)) return;
    const Cells columns = centresIn(low.x, high.x, field.width());
    const Cells rows = centresIn(low.y, high.y, field.height());
    const glm::dvec2 along = b - a;
    const double squared = glm::dot(along, along);
    for (int j = rows.first; j <= rows.last; ++j)
        for (int i = columns.first; i <= columns.last; ++i) {
            const glm::dvec2 fromStart = field.origin() + glm::dvec2(i + 0.5, j + 0.5) * cell - a;
            const double share = squared > 0 ? std::clamp(glm::dot(fromStart, along) / squared, 0.0, 1.0) : 0;
            const glm::dvec2 off = fromStart - share * along;
            if (glm::dot(off, off) <= reach * reach) field.set(i, j, -std::numeric_limits<float>::infinity());
        }
}

void clearLine(std::span<const glm::vec3> line, double reach, Heightfield& field) {
    for (std::size_t k = 0; k + 1 < line.size(); ++k)
        clearSegment(glm::dvec2(line[k]), glm::dvec2(line[k + 1]), reach, field);
}

}  // namespace

void clearLanes(const RoadNetwork& roads, float beside, Heightfield& field) {
    for (const Lane& lane : roads.lanes) clearLine(lane.centreLine, 0.5f * lane.width + beside, field);
    for (const Connection& way : roads.connections) {
        const float width =
            way.fromLane < roads.lanes.size() ? roads.lanes[way.fromLane].width : Lane{}.width;
        clearLine(way.centreLine, 0.5f * width + beside, field);
    }
}

}  // namespace city
