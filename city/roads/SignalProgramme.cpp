#include <algorithm>
#include <cmath>
#include <numbers>

#include "city/roads/JunctionWays.h"

namespace city {

namespace {

constexpr float greenTime = 18;       // seconds; the usual length in towns
constexpr float aloneGreenTime = 45;  // where nobody but pedestrians waits
constexpr float leftGreenTime = 8;
constexpr float amberTime = 3;     // 50 km/h: the time to brake at 2.3 m/s^2 after a second of thought
constexpr float clearingTime = 2;  // all red: a car that passed on amber leaves a 20 m crossing
constexpr float walkTime = 9;      // all red at a crossing for pedestrians alone
constexpr double opposing = 2.35;  // radians between approaches that may be green together
constexpr double leftTurn = 0.5;   // radians

std::uint64_t mixed(std::uint64_t x) {
    // SplitMix64's finaliser.
    x += 0x9e3779b97f4a7c15ULL;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
    return x ^ (x >> 31);
}

}  // namespace

void planSignals(NetworkDraft& draft, const std::vector<bool>& signalled) {
    RoadNetwork& roads = draft.roads;
    for (std::uint32_t j = 0; j < roads.junctions.size(); ++j) {
        Junction& junction = roads.junctions[j];
        if (!signalled[j] || junction.connections.empty()) continue;
        // Approaches by street; those that face each other are green together.
        struct Approach {
            std::uint32_t street;
            bool forward;
            glm::dvec3 direction;
            int pair = -1;
        };
        std::vector<Approach> approaches;
        const auto approachOf = [&](const Connection& c) {
            const LaneOrigin& o = draft.origins[c.fromLane];
            for (std::size_t i = 0; i < approaches.size(); ++i) {
                if (approaches[i].street == o.street && approaches[i].forward == o.forward) return i;
            }
            approaches.push_back({o.street, o.forward, endDirection(roads.lanes[c.fromLane].centreLine), -1});
            return approaches.size() - 1;
        };
        for (std::uint32_t c : junction.connections) approachOf(roads.connections[c]);
        int pairs = 0;
        for (std::size_t i = 0; i < approaches.size(); ++i) {
            if (approaches[i].pair >= 0) continue;
            approaches[i].pair = pairs;
            double best = opposing;
            std::size_t partner = approaches.size();
            for (std::size_t k = i + 1; k < approaches.size(); ++k) {
                const double a = std::abs(turnAngle(approaches[i].direction, approaches[k].direction));
                if (approaches[k].pair < 0 && a > best) {
                    best = a;
                    partner = k;
                }
            }
            if (partner < approaches.size()) approaches[partner].pair = pairs;
            // Parallel approaches (a tram line of its own beside the street) go along.
            for (std::size_t k = i + 1; k < approaches.size(); ++k) {
                const double a = std::abs(turnAngle(approaches[i].direction, approaches[k].direction));
                if (approaches[k].pair < 0 && (a < 0.35 || a > std::numbers::pi - 0.35))
                    approaches[k].pair = pairs;
            }
            ++pairs;
        }
        // Left turns have a phase of their own where each approach that turns left has a lane for it alone.
        std::vector<bool> protectedLeft(static_cast<std::size_t>(pairs), false);
        std::vector<bool> onlyLeft(roads.connections.size(), false);
        for (std::uint32_t c : junction.connections) {
            const auto& ways = roads.lanes[roads.connections[c].fromLane].connections;
            onlyLeft[c] = std::all_of(ways.begin(), ways.end(), [&](std::uint32_t w) {
                return turnOf(roads.connections[w]) > leftTurn;
            });
        }
        for (int p = 0; p < pairs; ++p) {
            std::vector<std::size_t> turning;
            bool all = true;
            bool through = false;
            for (std::uint32_t c : junction.connections) {
                const std::size_t a = approachOf(roads.connections[c]);
                if (approaches[a].pair != p) continue;
                const bool left = turnOf(roads.connections[c]) > leftTurn;
                through = through || !left;
                if (left) {
                    all = all && onlyLeft[c];
                    turning.push_back(a);
                }
            }
            protectedLeft[static_cast<std::size_t>(p)] = through && all && !turning.empty();
        }
        std::uint32_t group = 0;
        float cycle = 0;
        const auto add = [&](float duration, std::vector<std::uint32_t> groups, bool amber) {
            junction.signal.phases.push_back({duration, std::move(groups), amber});
            cycle += duration;
        };
        for (int p = 0; p < pairs; ++p) {
            const std::uint32_t through = group++;
            const bool ownLeft = protectedLeft[static_cast<std::size_t>(p)];
            const std::uint32_t left = ownLeft ? group++ : through;
            for (std::uint32_t c : junction.connections) {
                Connection& connection = roads.connections[c];
                if (approaches[approachOf(connection)].pair != p) continue;
                connection.signalGroup = turnOf(connection) > leftTurn ? left : through;
            }
            add(pairs == 1 ? aloneGreenTime : greenTime, {through}, false);
            add(amberTime, {through}, true);
            add(pairs == 1 && !ownLeft ? walkTime : clearingTime, {}, false);
            if (ownLeft) {
                add(leftGreenTime, {left}, false);
                add(amberTime, {left}, true);
                add(clearingTime, {}, false);
            }
        }
        junction.signal.offset = static_cast<float>(
            cycle * (static_cast<double>(mixed(draft.layout->junctions[j].nodes.front()) >> 11) * 0x1p-53));
        for (std::uint32_t c : junction.connections) {
            Connection& connection = roads.connections[c];
            std::erase_if(connection.yieldsTo, [&](std::uint32_t other) {
                return roads.connections[other].signalGroup != connection.signalGroup;
            });
        }
    }
}

}  // namespace city
