#include "city/roads/JunctionWays.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numbers>

namespace city {

namespace {

constexpr double curveSpacing = 0.75;  // metres between points of a curve
constexpr double straightTurn = 0.6;   // radians; less of a turn counts as straight on
constexpr double sharpestTurn =
    2.75;  // radians; beyond it is turning back, done only where nothing else is left
constexpr double sharpestTramTurn = 1.9;  // radians; rails do not bend further
constexpr double looseEndReach =
    60.0;  // metres between the carriageways of a dual road cut off by the map's edge

struct Exit {
    std::uint32_t arm = 0;
    double turn = 0;
    std::vector<std::uint32_t> lanes;  ///< from the kerb inwards
};

Polyline curveBetween(const NetworkDraft& draft, std::uint32_t from, std::uint32_t to) {
    const Lane& a = draft.roads.lanes[from];
    const Lane& b = draft.roads.lanes[to];
    const glm::dvec3 u = endDirection(a.centreLine);
    const glm::dvec3 v = startDirection(b.centreLine);
    const glm::dvec3 p(a.centreLine.back());
    const glm::dvec3 q(b.centreLine.front());
    const double angle = turnAngle(u, v);
    const double cross = u.x * v.y - u.y * v.x;
    if (angle < -0.5 && cross < -0.2) {
        // Turning right: straight up to the corner, then around it at the kerb's radius; a wider arc would
        // cut across the pavement.
        const glm::dvec3 d = q - p;
        const double ahead = (d.x * v.y - d.y * v.x) / cross;
        const double behind = -(d.x * u.y - d.y * u.x) / cross;
        const double radius = kerbRadius + 0.5 * static_cast<double>(std::min(a.width, b.width));
        const double tangent = std::min({ahead, behind, radius * std::tan(-0.5 * angle)});
        if (tangent > 1) {
            Polyline line{p};
            const auto straight = [&](const glm::dvec3& target) {
                const glm::dvec3 start = line.back();
                const int n =
                    std::max(1, static_cast<int>(std::ceil(glm::distance(start, target) / curveSpacing)));
                for (int i = 1; i <= n; ++i)
                    line.push_back(glm::mix(start, target, static_cast<double>(i) / n));
            };
            straight(p + u * (ahead - tangent));
            const Polyline arc = smoothCurve(line.back(), u, q - v * (behind - tangent), v, curveSpacing);
            line.insert(line.end(), arc.begin(), arc.end());
            straight(q);
            return withoutDuplicates(line, 1e-3);
        }
    }
    return smoothCurve(p, u, q, v, curveSpacing);
}

/// A turning bulb: out to the right, around to the left, back. As large as the room ahead of the lane's end
/// allows.
Polyline turningBulb(const NetworkDraft& draft, std::uint32_t from, std::uint32_t to, double room) {
    const Lane& a = draft.roads.lanes[from];
    const Lane& b = draft.roads.lanes[to];
    const glm::dvec3 p(a.centreLine.back());
    const glm::dvec3 q(b.centreLine.front());
    const glm::dvec3 u = endDirection(a.centreLine);
    const glm::dvec3 v = startDirection(b.centreLine);
    const double half = 0.5 * glm::distance(p, q);
    const double radius = std::max(half, std::clamp(0.4 * room, 2.5, 6.0));
    if (radius <= half * 1.05 || turnAngle(u, -v) > 0.5 || turnAngle(u, -v) < -0.5) {
        return smoothCurve(p, u, q, v, curveSpacing);
    }
    const glm::dvec3 right = rightOf(u);
    const glm::dvec3 centre = 0.5 * (p + q) + u * std::max(1.5 * (radius - half), 0.5 * radius);
    Polyline line;
    const auto add = [&](const Polyline& part) { line.insert(line.end(), part.begin(), part.end()); };
    add(smoothCurve(p, u, centre + right * radius, u, curveSpacing));
    add(smoothCurve(centre + right * radius, u, centre + u * radius, -right, curveSpacing));
    add(smoothCurve(centre + u * radius, -right, centre - right * radius, -u, curveSpacing));
    add(smoothCurve(centre - right * radius, -u, q, v, curveSpacing));
    return withoutDuplicates(line, 1e-3);
}

/// Which lanes of an approach lead where. Lanes and exits from the kerb inwards; exits right to left by turn.
struct Turn {
    std::uint32_t lane;
    std::uint32_t target;
};

std::vector<Turn> assignTurns(const std::vector<std::uint32_t>& lanes, std::vector<Exit> exits) {
    std::vector<Turn> out;
    if (lanes.empty() || exits.empty()) return out;
    std::sort(exits.begin(), exits.end(), [](const Exit& a, const Exit& b) { return a.turn < b.turn; });
    // The straightest exit, if straight at all; what lies right of it is a right turn, left of it a left
    // turn.
    std::size_t straight = exits.size();
    for (std::size_t i = 0; i < exits.size(); ++i) {
        if (std::abs(exits[i].turn) < straightTurn &&
            (straight == exits.size() || std::abs(exits[i].turn) < std::abs(exits[straight].turn))) {
            straight = i;
        }
    }
    std::vector<const Exit*> rights;
    std::vector<const Exit*> lefts;
    for (std::size_t i = 0; i < exits.size(); ++i) {
        if (i == straight) continue;
        const bool right = straight < exits.size() ? i < straight : exits[i].turn < 0;
        (right ? rights : lefts).push_back(&exits[i]);
    }
    const std::size_t n = lanes.size();
    const auto at = [](const Exit& exit, std::size_t fromKerb) {
        return exit.lanes[std::min(fromKerb, exit.lanes.size() - 1)];
    };
    const auto fromInside = [](const Exit& exit, std::size_t k) {
        return exit.lanes[exit.lanes.size() - 1 - std::min(k, exit.lanes.size() - 1)];
    };
    if (straight < exits.size()) {
        const Exit& on = exits[straight];
        for (const Exit* exit : rights) out.push_back({lanes.front(), at(*exit, 0)});
        for (const Exit* exit : lefts) out.push_back({lanes.back(), fromInside(*exit, 0)});
        // With three lanes and more the inner one is for turning left alone; where the street goes on
        // narrower, so are the outer ones.
        std::size_t first = 0;
        std::size_t last = n;
        if (!lefts.empty() && (n >= 3 || (n == 2 && on.lanes.size() < 2))) --last;
        if (!rights.empty() && last - first > on.lanes.size() && last - first > 1) ++first;
        for (std::size_t k = first; k < last; ++k) out.push_back({lanes[k], at(on, k - first)});
    } else {
        // A street that ends here: the lanes are shared out between right and left.
        std::size_t forRight = rights.empty() ? 0 : lefts.empty() ? n : std::max<std::size_t>(1, n / 2);
        for (const Exit* exit : rights) {
            for (std::size_t k = 0; k < forRight && k < std::max<std::size_t>(1, exit->lanes.size()); ++k) {
                out.push_back({lanes[k], at(*exit, k)});
            }
        }
        const std::size_t forLeft = lefts.empty()    ? 0
                                    : rights.empty() ? n
                                                     : std::max<std::size_t>(1, n - forRight);
        for (const Exit* exit : lefts) {
            for (std::size_t k = 0; k < forLeft && k < std::max<std::size_t>(1, exit->lanes.size()); ++k) {
                out.push_back({lanes[n - 1 - k], fromInside(*exit, k)});
            }
        }
    }
    // No lane may be left without a way on: it takes the exit that its neighbours lean to.
    for (std::size_t k = 0; k < n; ++k) {
        const bool used =
            std::any_of(out.begin(), out.end(), [&](const Turn& t) { return t.lane == lanes[k]; });
        if (used) continue;
        const Exit& exit = straight < exits.size()      ? exits[straight]
                           : k < n / 2 || lefts.empty() ? exits.front()
                                                        : exits.back();
        out.push_back({lanes[k], at(exit, k)});
    }
    return out;
}

void connectKind(NetworkDraft& draft, std::uint32_t j, LaneKind kind) {
    const StreetJunction& junction = draft.layout->junctions[j];
    const std::vector<LaneEnd> in = lanesInto(draft, j);
    const std::vector<LaneEnd> out = lanesOutOf(draft, j);
    const auto ofKind = [&](const LaneEnd& end) { return draft.roads.lanes[end.lane].kind == kind; };
    for (std::uint32_t a = 0; a < junction.arms.size(); ++a) {
        std::vector<std::uint32_t> lanes;
        for (const LaneEnd& end : in) {
            if (end.arm == a && ofKind(end)) lanes.push_back(end.lane);
        }
        if (lanes.empty()) continue;
        std::sort(lanes.begin(), lanes.end(),
                  [&](auto x, auto y) { return draft.origins[x].fromKerb < draft.origins[y].fromKerb; });
        const StreetJunction::Arm& from = junction.arms[a];
        const Street& street = draft.layout->streets[from.street];
        const glm::dvec3 u = endDirection(draft.roads.lanes[lanes.front()].centreLine);
        std::vector<Exit> exits;
        std::vector<Exit> back;
        for (std::uint32_t b = 0; b < junction.arms.size(); ++b) {
            const StreetJunction::Arm& to = junction.arms[b];
            Exit exit{b, 0, {}};
            for (const LaneEnd& end : out) {
                if (end.arm == b && ofKind(end)) exit.lanes.push_back(end.lane);
            }
            if (exit.lanes.empty()) continue;
            std::sort(exit.lanes.begin(), exit.lanes.end(),
                      [&](auto x, auto y) { return draft.origins[x].fromKerb < draft.origins[y].fromKerb; });
            const Street& target = draft.layout->streets[to.street];
            if (!junction.reachable(street.node[static_cast<std::size_t>(from.end)],
                                    target.node[static_cast<std::size_t>(to.end)])) {
                continue;
            }
            exit.turn = turnAngle(u, startDirection(draft.roads.lanes[exit.lanes.front()].centreLine));
            const double sharpest = kind == LaneKind::tram ? sharpestTramTurn : sharpestTurn;
            // Two streets that meet at any angle are one street with a bend.
            const bool bend = junction.arms.size() == 2;
            const bool turnsBack = to.street == from.street && to.end == from.end;
            const bool sharp = !bend && std::abs(exit.turn) > sharpest;
            (turnsBack || sharp ? back : exits).push_back(std::move(exit));
        }
        if (kind == LaneKind::tram && !exits.empty()) {
            // Rails lead on by the straightest way, and off it only where the line itself turns or forks.
            std::sort(exits.begin(), exits.end(),
                      [](const Exit& x, const Exit& y) { return std::abs(x.turn) < std::abs(y.turn); });
        }
        if (!exits.empty()) {
            if (kind == LaneKind::tram) {
                for (const Exit& exit : exits) {
                    connect(draft, j, lanes.front(), exit.lanes.front(),
                            curveBetween(draft, lanes.front(), exit.lanes.front()));
                }
            } else {
                for (const Turn& turn : assignTurns(lanes, exits)) {
                    connect(draft, j, turn.lane, turn.target, curveBetween(draft, turn.lane, turn.target));
                }
            }
            continue;
        }
        if (back.empty()) continue;
        // Nothing but turning back: into the same street where it has lanes the other way.
        std::sort(back.begin(), back.end(), [&](const Exit& x, const Exit& y) {
            const bool sameX =
                junction.arms[x.arm].street == from.street && junction.arms[x.arm].end == from.end;
            const bool sameY =
                junction.arms[y.arm].street == from.street && junction.arms[y.arm].end == from.end;
            return sameX != sameY ? sameX : x.arm < y.arm;
        });
        const Exit& exit = back.front();
        const double room = junction.arms.size() == 1 ? street.stop[static_cast<std::size_t>(from.end)] : 6.0;
        for (std::size_t k = 0; k < lanes.size(); ++k) {
            const std::size_t inner =
                exit.lanes.size() - 1 - std::min(lanes.size() - 1 - k, exit.lanes.size() - 1);
            connect(draft, j, lanes[k], exit.lanes[inner],
                    kind == LaneKind::tram
                        ? curveBetween(draft, lanes[k], exit.lanes[inner])  // over to the other track
                        : turningBulb(draft, lanes[k], exit.lanes[inner], room));
        }
    }
}

/// One-way streets that the edge of the map cuts off: their ends lead to the nearest beginning that nothing
/// leads to.
void linkLooseEnds(NetworkDraft& draft) {
    RoadNetwork& roads = draft.roads;
    std::vector<bool> reached(roads.lanes.size(), false);
    for (const Connection& c : roads.connections) reached[c.toLane] = true;
    for (std::uint32_t i = 0; i < roads.lanes.size(); ++i) {
        if (!roads.lanes[i].connections.empty()) continue;
        const glm::vec3 end = roads.lanes[i].centreLine.back();
        std::uint32_t best = noIndex;
        double bestDistance = looseEndReach;
        for (std::uint32_t k = 0; k < roads.lanes.size(); ++k) {
            if (reached[k] || roads.lanes[k].kind != roads.lanes[i].kind) continue;
            const double d = glm::distance(end, roads.lanes[k].centreLine.front());
            if (d < bestDistance) {
                bestDistance = d;
                best = k;
            }
        }
        if (best == noIndex) continue;
        const LaneOrigin& origin = draft.origins[i];
        const std::uint32_t j = draft.layout->streets[origin.street].junction[origin.forward ? 1 : 0];
        connect(draft, j, i, best, turningBulb(draft, i, best, 15));
    }
}

}  // namespace

glm::dvec3 endDirection(const std::vector<glm::vec3>& line) {
    const glm::dvec3 a(line[line.size() - 2]);
    const glm::dvec3 b(line.back());
    const double d = std::hypot(b.x - a.x, b.y - a.y);
    return d > 0 ? glm::dvec3((b.x - a.x) / d, (b.y - a.y) / d, 0) : glm::dvec3(1, 0, 0);
}

glm::dvec3 startDirection(const std::vector<glm::vec3>& line) {
    const glm::dvec3 a(line[0]);
    const glm::dvec3 b(line[1]);
    const double d = std::hypot(b.x - a.x, b.y - a.y);
    return d > 0 ? glm::dvec3((b.x - a.x) / d, (b.y - a.y) / d, 0) : glm::dvec3(1, 0, 0);
}

double turnOf(const Connection& connection) {
    double sum = 0;
    const auto& line = connection.centreLine;
    for (std::size_t i = 2; i < line.size(); ++i) {
        sum += turnAngle(glm::dvec3(line[i - 1] - line[i - 2]), glm::dvec3(line[i] - line[i - 1]));
    }
    return sum;
}

namespace {

std::vector<LaneEnd> lanesAt(const NetworkDraft& draft, std::uint32_t j, bool into) {
    std::vector<LaneEnd> out;
    const StreetJunction& junction = draft.layout->junctions[j];
    for (std::uint32_t a = 0; a < junction.arms.size(); ++a) {
        for (std::uint32_t lane : draft.lanesOfStreet[junction.arms[a].street]) {
            const bool endsHere = draft.origins[lane].forward == (junction.arms[a].end == 1);
            if (endsHere == into) out.push_back({lane, a});
        }
    }
    return out;
}

}  // namespace

std::vector<LaneEnd> lanesInto(const NetworkDraft& draft, std::uint32_t junction) {
    return lanesAt(draft, junction, true);
}

std::vector<LaneEnd> lanesOutOf(const NetworkDraft& draft, std::uint32_t junction) {
    return lanesAt(draft, junction, false);
}

void connect(NetworkDraft& draft, std::uint32_t junction, std::uint32_t from, std::uint32_t to,
             const Polyline& line) {
    for (std::uint32_t c : draft.roads.lanes[from].connections) {
        if (draft.roads.connections[c].toLane == to) return;
    }
    Connection connection;
    connection.fromLane = from;
    connection.toLane = to;
    connection.junction = junction;
    for (const glm::dvec3& p : line) {
        const glm::vec3 q(p);
        if (connection.centreLine.empty() || q != connection.centreLine.back())
            connection.centreLine.push_back(q);
    }
    const glm::vec3 start = draft.roads.lanes[from].centreLine.back();
    const glm::vec3 end = draft.roads.lanes[to].centreLine.front();
    if (connection.centreLine.size() < 2) connection.centreLine = {start, end};
    connection.centreLine.front() = start;
    connection.centreLine.back() = end;
    const auto index = static_cast<std::uint32_t>(draft.roads.connections.size());
    draft.roads.connections.push_back(std::move(connection));
    draft.roads.lanes[from].connections.push_back(index);
    draft.roads.junctions[junction].connections.push_back(index);
}

bool turnBack(NetworkDraft& draft, std::uint32_t from, std::uint32_t to) {
    const LaneOrigin& origin = draft.origins[from];
    const std::size_t before = draft.roads.connections.size();
    const std::uint32_t j = draft.layout->streets[origin.street].junction[origin.forward ? 1 : 0];
    const bool tram = draft.roads.lanes[from].kind == LaneKind::tram;
    connect(draft, j, from, to, tram ? curveBetween(draft, from, to) : turningBulb(draft, from, to, 6.0));
    return draft.roads.connections.size() > before;
}

void connectJunctions(NetworkDraft& draft) {
    for (std::uint32_t j = 0; j < draft.layout->junctions.size(); ++j) {
        connectKind(draft, j, LaneKind::car);
        connectKind(draft, j, LaneKind::tram);
    }
    linkLooseEnds(draft);
}

}  // namespace city
