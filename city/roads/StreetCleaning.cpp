#include "city/roads/StreetCleaning.h"

#include <numbers>

#include "city/roads/StreetLayout.h"

namespace city {

namespace {

constexpr double samePoint = 0.02;       // metres; two centimetres matter to no street
constexpr double shortestStub = 4.0;     // dead ends shorter than a car lead nowhere
constexpr double shortestTramSpur = 45;  // a tram does not fit on less
constexpr double longestRing = 300.0;    // way around the largest roundabout

struct Incidence {
    std::uint32_t edge;
    int end;
};

bool sameCrossSection(const StreetGraph::Edge& a, const StreetGraph::Edge& b) {
    const auto near = [](float x, float y) { return std::abs(x - y) < 0.05f; };
    return near(a.laneWidth, b.laneWidth) && near(a.medianWidth, b.medianWidth) && a.tram == b.tram &&
           a.cars == b.cars && near(a.pavementWidth, b.pavementWidth) &&
           std::abs(a.speedLimit - b.speedLimit) < 0.5f;
}

void turnAround(CleanStreets::Edge& edge) {
    std::swap(edge.from, edge.to);
    edge.shape = reversed(std::move(edge.shape));
    std::swap(edge.lanesForward, edge.lanesBackward);
    std::swap(edge.crossing[0], edge.crossing[1]);
}

}  // namespace

CleanStreets cleanStreets(const StreetGraph& graph) {
    CleanStreets out;
    const auto nodes = static_cast<std::uint32_t>(graph.nodes.size());
    for (const StreetGraph::Edge& edge : graph.edges) {
        if (edge.from >= nodes || edge.to >= nodes) continue;
        CleanStreets::Edge e;
        e.attributes = &edge;
        e.from = edge.from;
        e.to = edge.to;
        std::vector<glm::dvec3> points(edge.shape.begin(), edge.shape.end());
        if (points.size() < 2) points = {graph.nodes[edge.from].position, graph.nodes[edge.to].position};
        e.shape = withoutDuplicates(points, samePoint);
        e.lanesForward = std::clamp(edge.lanesForward, 0, 8);
        e.lanesBackward = std::clamp(edge.lanesBackward, 0, 8);
        e.crossing = {edge.crossingAtEnds, edge.crossingAtEnds};
        const double length = lengthOf(e.shape);
        if (e.shape.size() < 2 || length < 0.1 || (e.from == e.to && length < 12)) continue;
        if (e.lanesForward + e.lanesBackward == 0) continue;
        out.edges.push_back(std::move(e));
    }

    std::vector<std::vector<Incidence>> at(nodes);
    const auto fill = [&] {
        for (auto& list : at) list.clear();
        for (std::uint32_t i = 0; i < out.edges.size(); ++i) {
            at[out.edges[i].from].push_back({i, 0});
            at[out.edges[i].to].push_back({i, 1});
        }
    };
    fill();
    std::erase_if(out.edges, [&](const CleanStreets::Edge& e) {
        const bool deadEnd = at[e.from].size() == 1 || at[e.to].size() == 1;
        const bool alone = at[e.from].size() == 1 && at[e.to].size() == 1;
        if (!e.attributes->cars) return deadEnd && lengthOf(e.shape) < shortestTramSpur;
        return deadEnd && !alone && lengthOf(e.shape) < shortestStub;
    });
    fill();

    std::vector<bool> gone(out.edges.size(), false);
    for (std::uint32_t n = 0; n < nodes; ++n) {
        if (at[n].size() != 2 || graph.nodes[n].signalled) continue;
        const std::uint32_t ia = at[n][0].edge;
        const std::uint32_t ib = at[n][1].edge;
        if (ia == ib) continue;  // a ring with no other node: it must keep one
        CleanStreets::Edge& a = out.edges[ia];
        CleanStreets::Edge& b = out.edges[ib];
        if (!sameCrossSection(*a.attributes, *b.attributes)) continue;
        const bool flipA = at[n][0].end == 0;
        const bool flipB = at[n][1].end == 1;
        const int forwardA = flipA ? a.lanesBackward : a.lanesForward;
        const int backwardA = flipA ? a.lanesForward : a.lanesBackward;
        const int forwardB = flipB ? b.lanesBackward : b.lanesForward;
        const int backwardB = flipB ? b.lanesForward : b.lanesBackward;
        if (forwardA != forwardB || backwardA != backwardB) continue;
        const double turn = [&] {
            const Polyline pa = flipA ? reversed(a.shape) : a.shape;
            const Polyline pb = flipB ? reversed(b.shape) : b.shape;
            return turnAngle(directionAt(pa, lengthOf(pa)), directionAt(pb, 0));
        }();
        if (std::abs(turn) > 2.0) continue;  // a hairpin stays a node
        if (flipA) turnAround(a);
        if (flipB) turnAround(b);
        a.shape.insert(a.shape.end(), b.shape.begin(), b.shape.end());
        a.shape = withoutDuplicates(a.shape, samePoint);
        a.to = b.to;
        a.crossing[1] = b.crossing[1];
        gone[ib] = true;
        at[n].clear();
        // Turning an edge around changes which of its ends lies at its other nodes.
        for (Incidence& i : at[a.from]) {
            if (i.edge == ia) i.end = 0;
        }
        for (Incidence& i : at[a.to]) {
            if (i.edge == ib) i = {ia, 1};
        }
    }
    std::size_t kept = 0;
    for (std::size_t i = 0; i < out.edges.size(); ++i) {
        if (gone[i]) continue;
        if (kept != i) out.edges[kept] = std::move(out.edges[i]);
        ++kept;
    }
    out.edges.resize(kept);
    return out;
}

void markRings(StreetLayout& layout) {
    std::vector<Street>& streets = layout.streets;
    const auto oneWay = [](const Street& s) { return s.cars && (s.forward == 0) != (s.backward == 0); };
    const auto startNode = [](const Street& s) { return s.forward > 0 ? s.node[0] : s.node[1]; };
    const auto endNode = [](const Street& s) { return s.forward > 0 ? s.node[1] : s.node[0]; };
    const auto way = [](const Street& s) { return s.forward > 0 ? s.axis : reversed(s.axis); };
    std::uint32_t nodes = 0;
    for (const Street& s : streets) nodes = std::max({nodes, s.node[0] + 1, s.node[1] + 1});
    std::vector<std::vector<std::uint32_t>> leaving(nodes);
    for (std::uint32_t i = 0; i < streets.size(); ++i) {
        if (oneWay(streets[i])) leaving[startNode(streets[i])].push_back(i);
    }
    const auto totalTurn = [&](const Polyline& line) {
        double sum = 0;
        for (std::size_t i = 2; i < line.size(); ++i) {
            sum += turnAngle(line[i - 1] - line[i - 2], line[i] - line[i - 1]);
        }
        return sum;
    };
    for (std::uint32_t start = 0; start < streets.size(); ++start) {
        if (!oneWay(streets[start]) || streets[start].ring) continue;
        // Keeps to the left-most one-way street that turns less than a right angle: on a roundabout that is
        // the ring.
        std::vector<std::uint32_t> path{start};
        Polyline line = way(streets[start]);
        double turned = totalTurn(line);
        double length = streets[start].length;
        bool closed = endNode(streets[start]) == startNode(streets[start]);
        double closing = closed ? turnAngle(directionAt(line, length), directionAt(line, 0)) : 0;
        while (!closed && path.size() < 16 && length < longestRing) {
            const Polyline last = way(streets[path.back()]);
            const glm::dvec3 u = directionAt(last, lengthOf(last));
            std::uint32_t best = ~0U;
            double bestTurn = -1.0;
            for (std::uint32_t next : leaving[endNode(streets[path.back()])]) {
                const double t = turnAngle(u, directionAt(way(streets[next]), 0));
                if (t > bestTurn && t < 1.75) {
                    bestTurn = t;
                    best = next;
                }
            }
            if (best == ~0U) break;
            if (best == start) {
                closed = true;
                closing = bestTurn;
                break;
            }
            if (std::find(path.begin(), path.end(), best) != path.end()) break;
            path.push_back(best);
            turned += bestTurn + totalTurn(way(streets[best]));
            length += streets[best].length;
        }
        if (!closed || length > longestRing || length < 15) continue;
        if (std::abs(turned + closing - 2 * std::numbers::pi) > 1.0) continue;
        // Where four one-way carriageways cross, their square closes too, but streets run straight through
        // its corners.
        bool straightThrough = false;
        for (std::uint32_t i : path) {
            const Polyline mine = way(streets[i]);
            const glm::dvec3 u = directionAt(mine, lengthOf(mine));
            for (std::uint32_t next : leaving[endNode(streets[i])]) {
                if (std::find(path.begin(), path.end(), next) != path.end()) continue;
                straightThrough =
                    straightThrough ||
                    (path.size() <= 4 && std::abs(turnAngle(u, directionAt(way(streets[next]), 0))) < 0.2);
            }
        }
        if (straightThrough && path.size() == 4) continue;
        for (std::uint32_t i : path) streets[i].ring = true;
    }
}

}  // namespace city
