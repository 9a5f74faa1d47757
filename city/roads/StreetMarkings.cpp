#include "city/roads/StreetMarkings.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace city {

namespace {

constexpr double lineWidth = 0.12;  // metres, as on town streets
constexpr double dash = 3;
constexpr double gap = 4.5;
constexpr double stopLineWidth = 0.5;
constexpr double zebraDepth = 3;
constexpr double zebraBar = 0.5;
constexpr double gauge = 1.435;  // metres between the rails' inner edges
constexpr double railWidth = 0.07;

/// A line across a street at a distance from one of its ends, between two offsets to the right of the axis.
Polyline across(const Street& street, double along, double from, double to) {
    const glm::dvec3 p = pointAt(street.axis, along);
    const glm::dvec3 right = rightOf(directionAt(street.axis, along));
    return {p + right * from, p + right * to};
}

void addLine(std::vector<PaintedStrip>& out, const Street& street, double offset, bool dashed) {
    const double from = street.stop[0];
    const double to = street.length - street.stop[1];
    if (to - from < 2) return;
    if (!dashed) {
        out.push_back({offsetToTheRight(partOf(street.axis, from, to), offset), lineWidth});
        return;
    }
    // Whole dashes, the same gap everywhere, a dash at both ends.
    const int n = std::max(1, static_cast<int>(std::lround((to - from + gap) / (dash + gap))));
    const double pitch = n > 1 ? (to - from - dash) / (n - 1) : 0;
    for (int i = 0; i < n; ++i) {
        const double a = from + i * pitch;
        out.push_back({offsetToTheRight(partOf(street.axis, a, std::min(to, a + dash)), offset), lineWidth});
    }
}

void addZebra(std::vector<PaintedStrip>& out, const Street& street, double from, double to) {
    const double half = street.halfWidth();
    const int bars = std::max(1, static_cast<int>(std::floor((2 * half - 0.4) / (2 * zebraBar))));
    const double pitch = (2 * half - 0.4) / bars;
    for (int i = 0; i < bars; ++i) {
        const double offset = -half + 0.2 + (i + 0.5) * pitch;
        const bool onTracks = street.tram && std::abs(offset - street.medianOffset()) < 0.5 * street.median;
        if (onTracks) continue;
        out.push_back({offsetToTheRight(partOf(street.axis, from, to), offset), zebraBar});
    }
}

}  // namespace

std::vector<PaintedStrip> laneLines(const StreetLayout& layout) {
    std::vector<PaintedStrip> out;
    for (const Street& street : layout.streets) {
        if (!street.cars) continue;
        const double half = street.halfWidth();
        for (int k = 1; k < street.forward; ++k) addLine(out, street, half - k * street.laneWidth, true);
        for (int k = 1; k < street.backward; ++k) addLine(out, street, -half + k * street.laneWidth, true);
        if (street.forward == 0 || street.backward == 0) continue;
        if (street.median >= 0.6) {
            addLine(out, street, street.medianOffset() + 0.5 * street.median + 0.2, false);
            addLine(out, street, street.medianOffset() - 0.5 * street.median - 0.2, false);
        } else if (street.forward + street.backward > 2) {
            addLine(out, street, street.medianOffset() + 0.12, false);
            addLine(out, street, street.medianOffset() - 0.12, false);
        } else if (street.laneWidth >= 2.9) {
            addLine(out, street, street.medianOffset(), true);
        }
    }
    return out;
}

std::vector<PaintedStrip> stopLinesAndCrossings(const StreetLayout& layout) {
    std::vector<PaintedStrip> out;
    for (const StreetJunction& junction : layout.junctions) {
        for (const StreetJunction::Arm& arm : junction.arms) {
            const Street& street = layout.streets[arm.street];
            if (!street.cars) continue;
            const auto end = static_cast<std::size_t>(arm.end);
            const auto along = [&](double fromEnd) {
                return arm.end == 0 ? fromEnd : street.length - fromEnd;
            };
            if (street.crossing[end]) {
                const double a = along(street.cut[end] + 0.5);
                const double b = along(street.cut[end] + 0.5 + zebraDepth);
                addZebra(out, street, std::min(a, b), std::max(a, b));
            } else if (junction.signalled && junction.arms.size() == 2) {
                // A crossing of its own: half of it lies on each of the two streets that meet under it.
                const double a = along(0);
                const double b = along(0.5 * zebraDepth);
                addZebra(out, street, std::min(a, b), std::max(a, b));
            }
            if (!junction.signalled) continue;
            double from = 1e9;
            double to = -1e9;
            for (const Street::LaneStrip& lane : street.lanes) {
                if (lane.tram || lane.forward != (arm.end == 1)) continue;
                from = std::min(from, lane.offset - 0.5 * lane.width);
                to = std::max(to, lane.offset + 0.5 * lane.width);
            }
            if (from < to) {
                out.push_back(
                    {across(street, along(street.stop[end] - 0.5 * stopLineWidth), from + 0.1, to - 0.1),
                     stopLineWidth});
            }
        }
    }
    return out;
}

std::vector<PaintedStrip> railsOf(const RoadNetwork& roads) {
    std::vector<PaintedStrip> out;
    const auto add = [&](const std::vector<glm::vec3>& centre) {
        const Polyline line(centre.begin(), centre.end());
        for (double side : {-1.0, 1.0}) {
            out.push_back({offsetToTheRight(line, side * 0.5 * (gauge + railWidth)), railWidth});
        }
    };
    for (const Lane& lane : roads.lanes) {
        if (lane.kind == LaneKind::tram) add(lane.centreLine);
    }
    for (const Connection& connection : roads.connections) {
        if (roads.lanes[connection.fromLane].kind == LaneKind::tram) add(connection.centreLine);
    }
    return out;
}

}  // namespace city
