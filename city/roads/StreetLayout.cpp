#include "city/roads/StreetLayout.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "city/roads/StreetCleaning.h"

namespace city {

namespace {

constexpr double crossingDepth = 4.5;  // zebra of 3 m with half a metre and a metre of free asphalt beside it
constexpr double stopSetback = 0.8;    // from the junction's area to the stop line where there is no crossing
constexpr double longestCut = 24.0;    // streets that part at an acute angle overlap for ever; they stop here
constexpr double turningRoom = 15.0;   // length of a turning bulb at a dead end
constexpr double waitingRoom = 10.0;   // lanes between two crossings hold a car, or the crossings are one
constexpr double clusterReach = 55.0;  // no joined crossing is wider than this

/// How far from its end a street's carriageway still overlaps another street's of the same junction.
double overlapWith(const Street& street, int end, const Street& other, int otherEnd) {
    const double step = 0.5;
    const Polyline mine = end == 0 ? street.axis : reversed(street.axis);
    const Polyline reach = otherEnd == 0 ? partOf(other.axis, 0, 60) : partOf(reversed(other.axis), 0, 60);
    if (mine.size() < 2 || reach.size() < 2) return 0;
    const double limit = std::min(longestCut, street.length);
    double cut = 0;
    int clear = 0;
    for (double s = 0; s <= limit && clear < 6; s += step) {
        const glm::dvec3 p = pointAt(mine, s);
        const glm::dvec3 right = rightOf(directionAt(mine, s));
        bool overlaps = false;
        for (double f : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
            const Nearest n = nearestOn(reach, p + right * (f * street.halfWidth()));
            overlaps = overlaps || (!n.beforeStart && n.distance < other.halfWidth() - 0.05);
        }
        clear = overlaps ? 0 : clear + 1;
        if (overlaps) cut = s + step;
    }
    return std::min(cut, limit);
}

void sortArms(StreetLayout& layout, StreetJunction& junction) {
    const auto angle = [&](const StreetJunction::Arm& arm) {
        const Street& street = layout.streets[arm.street];
        const glm::dvec3 d = leavingDirection(street, arm.end);
        return std::atan2(d.y, d.x);
    };
    std::stable_sort(junction.arms.begin(), junction.arms.end(),
                     [&](const auto& a, const auto& b) { return angle(a) < angle(b); });
}

void cutArms(StreetLayout& layout, bool withCrossings) {
    for (StreetJunction& junction : layout.junctions) {
        for (const StreetJunction::Arm& arm : junction.arms) {
            Street& street = layout.streets[arm.street];
            double cut = 0;
            for (const StreetJunction::Arm& other : junction.arms) {
                if (other.street == arm.street) continue;
                cut = std::max(cut, overlapWith(street, arm.end, layout.streets[other.street], other.end));
            }
            const auto end = static_cast<std::size_t>(arm.end);
            const std::size_t degree = junction.arms.size();
            street.crossing[end] = false;
            if (degree == 1) {
                street.cut[end] = 0;
                street.stop[end] = std::min(turningRoom, 0.35 * street.length);
            } else if (degree == 2) {
                street.cut[end] = cut;
                street.stop[end] = cut + (junction.signalled ? 3.5 : 1.0);
            } else {
                const Street::LaneStrip* widest = street.lanes.empty() ? nullptr : &street.lanes.front();
                const bool zebra = withCrossings && street.cars && widest != nullptr &&
                                   (street.pavement > 0 || junction.signalled) && !street.ring;
                street.cut[end] = cut + kerbRadius;
                street.crossing[end] = zebra;
                street.stop[end] = street.cut[end] + (zebra ? crossingDepth : stopSetback);
            }
        }
    }
}

/// Streets too short for what their ends ask give up the crossings first, then share what is left.
void fitCuts(Street& street, const std::array<bool, 2>& wantsCrossing) {
    const double lane = std::min(10.0, 0.5 * street.length);
    for (std::size_t e : {0U, 1U}) {
        if (street.crossing[e] && !wantsCrossing[e]) {
            street.crossing[e] = false;
            street.stop[e] = street.cut[e] + stopSetback;
        }
    }
    if (street.stop[0] + street.stop[1] > street.length - lane) {
        for (std::size_t e : {0U, 1U}) {
            if (street.crossing[e]) street.stop[e] = street.cut[e] + stopSetback;
            street.crossing[e] = false;
        }
    }
    const double sum = street.stop[0] + street.stop[1];
    if (sum > street.length - lane) {
        const double scale = (street.length - lane) / sum;
        for (std::size_t e : {0U, 1U}) {
            street.stop[e] *= scale;
            street.cut[e] *= scale;
        }
    }
}

void addLanes(Street& street) {
    const double w = street.laneWidth;
    const double half = street.halfWidth();
    const double middle = street.medianOffset();
    if (!street.cars) {
        const double beside = street.forward > 0 && street.backward > 0 ? 0.5 * w + 0.5 * street.median : 0;
        if (street.forward > 0) street.lanes.push_back({beside, w, true, true, 0});
        if (street.backward > 0) street.lanes.push_back({-beside, w, false, true, 0});
        return;
    }
    const double tramWidth = 3.0;
    const bool ownBed = street.tram && street.median >= 2 * 2.75;
    for (const bool forward : {true, false}) {
        const int n = forward ? street.forward : street.backward;
        const double sign = forward ? 1 : -1;
        // Without a bed of its own the tram has the inner lane to itself; a single lane it shares with the
        // cars.
        const bool takesLane = street.tram && !ownBed && n >= 2;
        const int carLanes = takesLane ? n - 1 : n;
        for (int k = 0; k < carLanes; ++k) {
            street.lanes.push_back({sign * (half - (k + 0.5) * w), w, forward, false, k});
        }
        if (ownBed) {
            const double beside = std::max(0.5 * tramWidth, 0.25 * std::min(street.median, 7.0));
            street.lanes.push_back({middle + sign * beside, tramWidth, forward, true, n});
        } else if (street.tram && n >= 1) {
            street.lanes.push_back({sign * (half - (n - 0.5) * w), w, forward, true, n});
        }
    }
}

}  // namespace

double Street::halfWidth() const {
    return 0.5 * ((forward + backward) * laneWidth + median);
}

double Street::medianOffset() const {
    return halfWidth() - forward * laneWidth - 0.5 * median;
}

bool Street::drivable(int fromEnd) const {
    return std::any_of(lanes.begin(), lanes.end(),
                       [&](const LaneStrip& lane) { return lane.forward == (fromEnd == 0); });
}

bool StreetJunction::reachable(std::uint32_t fromNode, std::uint32_t toNode) const {
    std::vector<std::uint32_t> seen{fromNode};
    for (std::size_t i = 0; i < seen.size(); ++i) {
        if (seen[i] == toNode) return true;
        for (const auto& [a, b] : inner) {
            if (a == seen[i] && std::find(seen.begin(), seen.end(), b) == seen.end()) seen.push_back(b);
        }
    }
    return false;
}

glm::dvec3 leavingDirection(const Street& street, int end) {
    const double s = street.stop[static_cast<std::size_t>(end)];
    return end == 0 ? directionAt(street.axis, s) : -directionAt(street.axis, street.length - s);
}

StreetLayout layOutStreets(const StreetGraph& graph) {
    CleanStreets clean = cleanStreets(graph);
    StreetLayout layout;
    std::vector<std::array<bool, 2>> wantsCrossing;
    for (CleanStreets::Edge& edge : clean.edges) {
        Street street;
        const StreetGraph::Edge& a = *edge.attributes;
        street.forward = edge.lanesForward;
        street.backward = edge.lanesBackward;
        street.laneWidth =
            std::isfinite(a.laneWidth) ? std::clamp(static_cast<double>(a.laneWidth), 2.75, 6.0) : 3.25;
        street.median =
            std::isfinite(a.medianWidth) ? std::clamp(static_cast<double>(a.medianWidth), 0.0, 60.0) : 0;
        street.pavement =
            std::isfinite(a.pavementWidth) ? std::clamp(static_cast<double>(a.pavementWidth), 0.0, 30.0) : 0;
        street.tram = a.tram;
        street.cars = a.cars;
        street.speedLimit = std::isfinite(a.speedLimit) ? std::clamp(a.speedLimit, 1.5f, 40.0f) : 13.9f;
        street.axis = rounded(edge.shape, street.halfWidth() + 6);
        street.length = lengthOf(street.axis);
        street.node = {edge.from, edge.to};
        addLanes(street);
        wantsCrossing.push_back(edge.crossing);
        layout.streets.push_back(std::move(street));
    }
    markRings(layout);

    // One junction a node first: how much room each crossing needs decides which crossings are one.
    const auto fillJunctions = [&](const std::vector<std::uint32_t>& owner) {
        layout.junctions.clear();
        std::vector<std::uint32_t> index(graph.nodes.size(), ~0U);
        const auto junctionOf = [&](std::uint32_t node) {
            const std::uint32_t root = owner[node];
            if (index[root] == ~0U) {
                index[root] = static_cast<std::uint32_t>(layout.junctions.size());
                layout.junctions.emplace_back();
            }
            StreetJunction& junction = layout.junctions[index[root]];
            if (std::find(junction.nodes.begin(), junction.nodes.end(), node) == junction.nodes.end()) {
                junction.nodes.push_back(node);
                junction.signalled = junction.signalled || graph.nodes[node].signalled;
            }
            return index[root];
        };
        for (std::uint32_t i = 0; i < layout.streets.size(); ++i) {
            Street& street = layout.streets[i];
            for (int e : {0, 1}) {
                const auto end = static_cast<std::size_t>(e);
                street.junction[end] = junctionOf(street.node[end]);
                layout.junctions[street.junction[end]].arms.push_back({i, e});
                layout.junctions[street.junction[end]].position +=
                    e == 0 ? street.axis.front() : street.axis.back();
            }
        }
        for (StreetJunction& junction : layout.junctions) {
            junction.position /= static_cast<double>(junction.arms.size());
            sortArms(layout, junction);
        }
    };
    std::vector<std::uint32_t> owner(graph.nodes.size());
    for (std::uint32_t i = 0; i < owner.size(); ++i) owner[i] = i;
    fillJunctions(owner);
    cutArms(layout, false);

    // Join.
    std::vector<Aabb2> reach(graph.nodes.size());
    for (const Street& street : layout.streets) {
        reach[street.node[0]].extend(street.axis.front());
        reach[street.node[1]].extend(street.axis.back());
    }
    const auto root = [&](std::uint32_t n) {
        while (owner[n] != n) n = owner[n];
        return n;
    };
    std::vector<std::uint32_t> shortest(layout.streets.size());
    for (std::uint32_t i = 0; i < shortest.size(); ++i) shortest[i] = i;
    std::stable_sort(shortest.begin(), shortest.end(),
                     [&](auto a, auto b) { return layout.streets[a].length < layout.streets[b].length; });
    for (std::uint32_t i : shortest) {
        const Street& street = layout.streets[i];
        const std::size_t degree0 = layout.junctions[street.junction[0]].arms.size();
        const std::size_t degree1 = layout.junctions[street.junction[1]].arms.size();
        if (street.ring || degree0 < 2 || degree1 < 2) continue;
        const bool crossings = degree0 >= 3 && degree1 >= 3;
        // Maps put the signals of a crossing where drivers stop for them, as nodes of their own.
        const auto mereSignal = [&](std::size_t end, std::size_t degree) {
            return degree == 2 && layout.junctions[street.junction[end]].signalled;
        };
        const bool signalOfCrossing = street.length < 25 && ((mereSignal(0, degree0) && degree1 >= 3) ||
                                                             (mereSignal(1, degree1) && degree0 >= 3));
        const bool tooShort = street.length < 6 || signalOfCrossing ||
                              (crossings && street.length < 42 &&
                               street.length < street.stop[0] + street.stop[1] + waitingRoom);
        const std::uint32_t a = root(street.node[0]);
        const std::uint32_t b = root(street.node[1]);
        if (!tooShort || a == b) continue;
        Aabb2 both = reach[a];
        both.extend(reach[b]);
        if (both.diagonal() > clusterReach) continue;
        owner[std::max(a, b)] = std::min(a, b);
        reach[std::min(a, b)] = both;
    }
    std::vector<std::pair<std::uint32_t, std::pair<std::uint32_t, std::uint32_t>>> inner;
    {
        std::vector<Street> kept;
        std::vector<std::array<bool, 2>> keptWants;
        for (std::size_t i = 0; i < layout.streets.size(); ++i) {
            Street& street = layout.streets[i];
            const std::uint32_t a = root(street.node[0]);
            const bool joined = a == root(street.node[1]) && street.node[0] != street.node[1] &&
                                !street.ring && street.length < 1.5 * clusterReach;
            if (joined) {
                if (street.drivable(0)) inner.push_back({a, {street.node[0], street.node[1]}});
                if (street.drivable(1)) inner.push_back({a, {street.node[1], street.node[0]}});
            } else {
                kept.push_back(std::move(street));
                keptWants.push_back(wantsCrossing[i]);
            }
        }
        layout.streets = std::move(kept);
        wantsCrossing = std::move(keptWants);
    }
    for (std::uint32_t i = 0; i < owner.size(); ++i) owner[i] = root(i);
    fillJunctions(owner);
    for (StreetJunction& junction : layout.junctions) {
        for (const auto& [cluster, way] : inner) {
            if (cluster == owner[junction.nodes.front()]) junction.inner.push_back(way);
        }
    }
    cutArms(layout, true);
    for (std::size_t i = 0; i < layout.streets.size(); ++i) fitCuts(layout.streets[i], wantsCrossing[i]);
    for (StreetJunction& junction : layout.junctions) sortArms(layout, junction);
    return layout;
}

}  // namespace city
