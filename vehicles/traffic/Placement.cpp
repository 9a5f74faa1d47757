#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "vehicles/traffic/TrafficState.h"

namespace vehicles {

namespace {

constexpr double placingGap = 3.0;   // metres between vehicles at the start: enough that all can move off
constexpr double arrivalGap = 30.0;  // metres free behind a vehicle that comes in later
constexpr int randomTries = 24;      // random places tried before the streets are searched in order

struct Spot {
    std::uint32_t way;
    double s;
};

}  // namespace

/// Places a vehicle with its front at s of a lane, if it stands clear of zones and of the others there.
bool Traffic::State::tryPlace(std::uint32_t kind, std::uint32_t w, double s) {
    const Way& way = net.ways[w];
    const VehicleKind& k = kinds[kind];
    const double rear = s - k.length;
    if (k.tram != way.tram || rear < 0.5 || s > way.length - 0.5) return false;
    for (const Way::ZoneSide& zone : way.zones) {
        if (zone.begin < s + 0.5 && zone.end > rear - 0.5) return false;
    }
    const auto blocked = [&](std::uint32_t lane, double from, double to) {
        for (std::uint32_t u : placed[lane]) {
            if (vehicles[u].front > from && vehicles[u].rear() < to) return true;
        }
        return false;
    };
    if (blocked(w, rear - placingGap, s + placingGap)) return false;
    for (const Way::Shared& shared : way.shared) {
        const double from = shared.otherBegin + (rear - placingGap - shared.begin) * shared.scale;
        const double to = shared.otherBegin + (s + placingGap - shared.begin) * shared.scale;
        if (blocked(shared.other, from, to)) return false;
    }
    Vehicle v;
    v.id = nextId++;
    v.kind = kind;
    v.length = k.length;
    v.front = s;
    v.path = {w};
    v.starts = {0, way.length};
    v.granted = s;
    const auto index = static_cast<std::uint32_t>(vehicles.size());
    v.random.state = options.seed * 0x9e3779b97f4a7c15ULL + index;
    v.random.next();
    v.temper = 0.88 + 0.22 * v.random.unit();
    placed[w].push_back(index);
    vehicles.push_back(std::move(v));
    return true;
}

/// A vehicle that has stood for minutes in front of a crossing that will not clear leaves, and another of its
/// kind comes in at a free place elsewhere: the last resort against knots that random routes tie in networks
/// full of short lanes.
void Traffic::State::relocate(std::uint32_t index) {
    Vehicle& v = vehicles[index];
    const auto blocked = [&](std::uint32_t lane, double from, double to) {
        for (std::uint32_t e = listStart[lane]; e < listStart[lane + 1]; ++e) {
            const Entry& u = entries[e];
            if (u.vehicle != index && u.front > from && u.front - vehicles[u.vehicle].length < to)
                return true;
        }
        return false;
    };
    const auto lanes = static_cast<std::uint32_t>(roads->lanes.size());
    for (int i = 0; i < randomTries; ++i) {
        const std::uint32_t w = relocation.below(lanes);
        const Way& way = net.ways[w];
        const double s = relocation.unit() * way.length;
        const double rear = s - v.length;
        if (way.tram != kinds[v.kind].tram || rear < 0.5 || s > way.length - 0.5) continue;
        const bool onZone = std::any_of(way.zones.begin(), way.zones.end(), [&](const Way::ZoneSide& zone) {
            return zone.begin < s + 0.5 && zone.end > rear - 0.5;
        });
        // Room for whoever comes from behind to brake without haste.
        bool taken = onZone || blocked(w, rear - arrivalGap, s + 2 * placingGap);
        for (const std::uint32_t before : way.previous) {
            taken = taken ||
                    (rear < arrivalGap && blocked(before, net.ways[before].length - arrivalGap + rear, 1e9));
        }
        for (const Way::Shared& shared : way.shared) {
            const double from = shared.otherBegin + (rear - arrivalGap - shared.begin) * shared.scale;
            taken = taken || blocked(shared.other, from,
                                     shared.otherBegin + (s + 2 * placingGap - shared.begin) * shared.scale);
        }
        if (taken) continue;
        for (const ZoneHold& hold : v.holds) --zones[hold.zone].holders[hold.side];
        Vehicle fresh;
        fresh.id = nextId++;
        fresh.kind = v.kind;
        fresh.length = v.length;
        fresh.front = s;
        fresh.path = {w};
        fresh.starts = {0, way.length};
        fresh.granted = s;
        fresh.random = v.random;
        fresh.temper = v.temper;
        v = std::move(fresh);
        findNextStop(v);
        listVehicles();
        return;
    }
}

void Traffic::State::place() {
    placed.assign(net.ways.size(), {});
    relocation.state = options.seed ^ 0x6c656176696e67ULL;
    SeededRandom random{options.seed ^ 0x7472616666696321ULL};
    random.next();
    for (const bool trams : {false, true}) {
        const std::uint32_t wanted = trams ? options.trams : options.cars;
        std::vector<std::uint32_t> lanes;
        std::vector<double> upTo;
        double total = 0;
        for (std::uint32_t w = 0; w < roads->lanes.size(); ++w) {
            if (net.ways[w].tram != trams) continue;
            lanes.push_back(w);
            upTo.push_back(total += net.ways[w].length);
        }
        std::vector<std::uint32_t> drawn;
        double shares = 0;
        for (std::uint32_t k = 0; k < kinds.size(); ++k) {
            if (kinds[k].tram != trams || !(kinds[k].share > 0)) continue;
            drawn.push_back(k);
            shares += kinds[k].share;
        }
        if (lanes.empty() || drawn.empty()) continue;
        std::uint32_t shortest = drawn.front();
        for (std::uint32_t k : drawn) shortest = kinds[k].length < kinds[shortest].length ? k : shortest;
        const auto drawKind = [&] {
            double x = random.unit() * shares;
            for (std::uint32_t k : drawn) {
                x -= kinds[k].share;
                if (x < 0) return k;
            }
            return drawn.back();
        };
        std::uint32_t count = 0;
        const double pitch = 1.0;
        if (options.focus) {
            // Nearest places first.
            std::vector<std::pair<double, Spot>> spots;
            const glm::dvec3 centre(options.focus->centre);
            for (std::uint32_t w : lanes) {
                for (double s = 1; s < net.ways[w].length; s += pitch) {
                    const double d = glm::distance(net.pointAt(w, s), centre);
                    if (d <= options.focus->radius) spots.push_back({d, {w, s}});
                }
            }
            std::stable_sort(spots.begin(), spots.end(),
                             [](const auto& a, const auto& b) { return a.first < b.first; });
            std::uint32_t kind = drawKind();
            for (const auto& [d, spot] : spots) {
                if (count >= wanted) break;
                if (tryPlace(kind, spot.way, spot.s + 0.5 * kinds[kind].length)) {
                    ++count;
                    kind = drawKind();
                }
            }
        }
        std::size_t sweepLane = 0;
        double sweepAt = 0;
        while (count < wanted) {
            const std::uint32_t kind = drawKind();
            bool done = false;
            for (int i = 0; i < randomTries && !done; ++i) {
                const double x = random.unit() * total;
                const auto k =
                    static_cast<std::size_t>(std::lower_bound(upTo.begin(), upTo.end(), x) - upTo.begin());
                const std::uint32_t w = lanes[std::min(k, lanes.size() - 1)];
                done = tryPlace(kind, w, random.unit() * net.ways[w].length);
            }
            // The streets are nearly full: what is left is searched in order, with the shortest kind where
            // the drawn one is too long.
            while (!done && sweepLane < lanes.size()) {
                done = tryPlace(kind, lanes[sweepLane], sweepAt) ||
                       tryPlace(shortest, lanes[sweepLane], sweepAt);
                if (done) break;
                sweepAt += pitch;
                if (sweepAt > net.ways[lanes[sweepLane]].length) {
                    sweepAt = 0;
                    ++sweepLane;
                }
            }
            if (!done) break;
            ++count;
        }
    }
    // Moving from the start, as fast as the way ahead allows with comfortable braking.
    listVehicles();
    for (std::uint32_t i = 0; i < vehicles.size(); ++i) {
        Vehicle& v = vehicles[i];
        findNextStop(v);
        extend(v, v.front + 100);
        const Leader leader = leaderOf(v, i, 80);
        const double free = std::max(0.0, std::min(leader.gap - 3, v.nextStop - v.front - 1));
        v.speed = std::min(0.8 * freeSpeed(v), std::sqrt(2 * 1.2 * free));
    }
}

}  // namespace vehicles
