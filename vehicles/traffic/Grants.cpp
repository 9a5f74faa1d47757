#include <algorithm>
#include <cmath>

#include "vehicles/traffic/TrafficState.h"

namespace vehicles {

namespace {

constexpr double planAhead = 30;  // metres planned beyond what is needed
constexpr double longestGroup =
    250;  // metres of zones without a place to stand; beyond, they are taken as they come
constexpr double patience = 9;    // seconds before a vehicle that must yield goes where the way is free
constexpr double claimAfter = 5;  // seconds before a waiting vehicle holds back others that could still stop
constexpr double claimUntil = 14;
constexpr double claimPeriod = 20;
constexpr double otherWayAfter = 14;  // seconds before it looks for another way out
constexpr double yieldMargin =
    1.0;  // seconds between leaving a crossing and the arrival of who has right of way
constexpr double yieldReach = 60;       // metres up the other approach that a driver looks
constexpr double longestIdleGrant = 5;  // seconds
constexpr double amberBraking = 3.0;    // m/s^2; who would have to brake harder passes on amber

}  // namespace

/// First point beyond what is granted where something must be asked for: the stop line of a signal or of a
/// connection with zones, or a zone on a lane.
void Traffic::State::findNextStop(Vehicle& v) {
    v.stopIsPlan = false;
    for (std::size_t i = v.current;; ++i) {
        if (i >= v.path.size()) {
            const std::size_t known = v.path.size();
            if (v.starts.back() > v.front + 150) break;
            extend(v, v.starts.back() + 1);
            if (v.path.size() == known) break;
        }
        const Way& way = net.ways[v.path[i]];
        const double start = v.starts[i];
        if (way.connection && i > v.current && start > v.granted &&
            (way.signalGroup != city::noIndex || !way.zones.empty())) {
            v.nextStop = start;
            return;
        }
        for (const Way::ZoneSide& zone : way.zones) {
            if (start + zone.begin > v.granted && start + zone.begin > v.front) {
                v.nextStop = start + zone.begin;
                return;
            }
        }
    }
    v.nextStop = v.starts.back();
    v.stopIsPlan = !net.ways[v.path.back()].next.empty();
}

/// Gives back what it was granted but has not begun to use, where the signal has changed since and it can
/// still stop, or where it has stood for long (behind a leader, say) and only keeps others away.
void Traffic::State::reconsider(Vehicle& v) {
    if (v.granted <= v.front) return;
    bool giveBack = v.stood > longestIdleGrant;
    // Where it would have to stop then: at the first zone that it is not in yet.
    double first = v.granted;
    for (const ZoneHold& hold : v.holds) {
        if (hold.begin > v.front) first = std::min(first, hold.begin);
    }
    if (v.speed * v.speed >= 2 * amberBraking * (first - v.front)) return;
    for (std::size_t i = v.current + 1; i < v.path.size() && v.starts[i] < v.granted && !giveBack; ++i) {
        const Way& way = net.ways[v.path[i]];
        if (way.signalGroup == city::noIndex) continue;
        giveBack = colour(way.junction, way.signalGroup) != SignalColour::green &&
                   v.speed * v.speed < 2 * amberBraking * (v.starts[i] - v.front);
        break;
    }
    if (!giveBack) return;
    // A zone that it is in already stays, and with it all that were granted to leave it.
    for (const ZoneHold& hold : v.holds) {
        if (hold.begin <= v.front) return;
    }
    if (net.ways[v.path[v.current]].connection) return;
    std::erase_if(v.holds, [&](const ZoneHold& hold) {
        if (hold.begin <= v.front) return false;
        --zones[hold.zone].holders[hold.side];
        return true;
    });
    v.granted = v.front;
    findNextStop(v);
}

void Traffic::State::askForWay(std::uint32_t index, double dt) {
    Vehicle& v = vehicles[index];
    const double b = kinds[v.kind].deceleration;
    const double reach = v.speed * v.speed / (2 * b) + 1.2 * v.speed + 4;
    v.stood = v.speed < 0.05 ? v.stood + dt : 0;
    reconsider(v);
    if (v.stopIsPlan && v.nextStop - v.front < 100) findNextStop(v);
    for (int round = 0; round < 8 && v.nextStop - v.front < reach; ++round) {
        if (!grant(index)) {
            if (v.speed < 0.5 && v.nextStop - v.front < 6) v.waited += dt;
            if (v.waited > otherWayAfter + 4 * v.temper && v.current + 1 < v.path.size() &&
                !net.ways[v.path[v.current]].connection && net.ways[v.path[v.current]].next.size() > 1 &&
                v.granted <= v.starts[v.current + 1]) {
                shorten(v);
                findNextStop(v);
                v.waited = patience;
            }
            return;
        }
        v.waited = 0;
    }
}

/// Asks for everything from the next stop to the first place behind it where the vehicle can stand clear of
/// all zones. All or nothing: who holds a part and waits for the rest would lock the crossing.
bool Traffic::State::grant(std::uint32_t index) {
    Vehicle& v = vehicles[index];
    const double stop = v.nextStop;
    double end = stop;
    v.refusal = Refusal::none;
    const auto refuse = [&](Refusal why) {
        v.refusal = why;
        return false;
    };
    struct Wanted {
        std::uint32_t zone;
        std::uint8_t side;
        double begin;
        double end;
    };
    static thread_local std::vector<Wanted> wanted;
    static thread_local std::vector<std::size_t> crossed;
    wanted.clear();
    crossed.clear();
    const double room = v.length + standingGap;
    for (std::size_t i = v.current;; ++i) {
        if (i >= v.path.size()) {
            const std::size_t known = v.path.size();
            extend(v, v.starts.back() + 1);
            if (v.path.size() == known) break;
        }
        const double start = v.starts[i];
        if (start > end + room || end > stop + longestGroup) break;
        const Way& way = net.ways[v.path[i]];
        const bool needsLine = way.connection && (way.signalGroup != city::noIndex || !way.zones.empty());
        if (needsLine && i > v.current && start > v.granted && start >= stop && start < end + room) {
            // A second signal with no room to stand before it belongs to the same crossing; it is obeyed if
            // that can be.
            if (way.signalGroup != city::noIndex && (crossed.empty() || v.waited < patience)) {
                const SignalColour light = colour(way.junction, way.signalGroup);
                if (light == SignalColour::red) return refuse(Refusal::signal);
                const bool canStop = v.speed * v.speed < 2 * amberBraking * (start - v.front);
                if (light == SignalColour::amber && canStop) return refuse(Refusal::signal);
            }
            crossed.push_back(i);
            end = std::max(end, start);
        }
        for (const Way::ZoneSide& zone : way.zones) {
            const double from = start + zone.begin;
            if (from <= v.granted || start + zone.end < v.front) continue;
            // Nobody stops on a connection: the last place to stand is the lane before it.
            if ((way.connection ? start : from) > end + room) break;
            wanted.push_back({zone.zone, zone.side, from, start + zone.end});
            end = std::max(end, start + zone.end);
        }
    }
    extend(v, end + room + planAhead);
    bool taken = false;
    for (const Wanted& want : wanted) {
        const ZoneState& zone = zones[want.zone];
        int others = zone.holders[1 - want.side];
        for (const ZoneHold& hold : v.holds)
            others -= hold.zone == want.zone && hold.side != want.side ? 1 : 0;
        taken = taken || others > 0;
    }
    if (!roomBehind(v, index, end)) {
        return refuse(Refusal::noRoom);
    }
    // From here on only others' courtesy is missing: a long wait makes it felt.
    const auto claim = [&] {
        // Off and on, so that claims that cannot be met do not lock a crossing for good.
        const double turn = std::fmod(v.waited, claimPeriod);
        if (turn < claimAfter || turn > claimUntil) return;
        for (const Wanted& want : wanted) {
            ZoneState& zone = zones[want.zone];
            if (zone.claimed + 2 > substeps && zone.claimWait >= v.waited) continue;
            zone.claimed = substeps;
            zone.claimWait = v.waited;
            zone.claimSide = want.side;
        }
    };
    claim();
    if (taken) return refuse(Refusal::taken);
    for (const Wanted& want : wanted) {
        const ZoneState& zone = zones[want.zone];
        if (zone.claimSide != want.side && zone.claimed + 2 > substeps && zone.claimWait > v.waited)
            return refuse(Refusal::claimed);
    }
    for (std::size_t i : crossed) {
        if (mustYield(v, index, i, end + v.length - v.front)) {
            if (v.waited < patience * (0.8 + 0.4 * v.temper)) return refuse(Refusal::yields);
        }
    }
    for (const Wanted& want : wanted) {
        ++zones[want.zone].holders[want.side];
        v.holds.push_back({want.zone, want.side, want.begin, want.end});
    }
    v.granted = std::max(end, stop) + 1e-6;
    findNextStop(v);
    return true;
}

/// Whether somebody with right of way over a connection of the path would be there before this vehicle is
/// gone.
bool Traffic::State::mustYield(const Vehicle& v, std::uint32_t index, std::size_t pathIndex,
                               double clearDistance) const {
    const Way& mine = net.ways[v.path[pathIndex]];
    if (mine.yieldsTo.empty()) return false;
    const double a = kinds[v.kind].acceleration;
    const double top = 8;
    // Time to cover the distance from now, speeding up to what turns allow.
    double clearTime = (std::sqrt(v.speed * v.speed + 2 * a * clearDistance) - v.speed) / a;
    if (v.speed + a * clearTime > top) {
        const double t = std::max(0.0, (top - v.speed) / a);
        clearTime = t + std::max(0.0, clearDistance - v.speed * t - 0.5 * a * t * t) / top;
    }
    const auto arrives = [&](const Entry& e, std::uint32_t via, double toLine) {
        const Vehicle& u = vehicles[e.vehicle];
        if (e.vehicle == index || e.ghost || toLine < -0.5 || toLine > yieldReach) return false;
        if (u.refusal == Refusal::noRoom && u.speed < 1) return false;
        if (u.speed < 0.5 && toLine > 8) return false;
        // Does it go that way at all?
        bool comes = false;
        for (std::size_t i = u.current; i < u.path.size(); ++i) comes = comes || u.path[i] == via;
        if (!comes) return false;
        const double eta = toLine / std::max(u.speed, 2.5);
        return eta < clearTime + yieldMargin;
    };
    for (std::uint32_t via : mine.yieldsTo) {
        const Way& other = net.ways[via];
        if (other.signalGroup != city::noIndex &&
            colour(other.junction, other.signalGroup) == SignalColour::red)
            continue;
        const std::uint32_t lane = other.previous.front();
        const double length = net.ways[lane].length;
        for (std::uint32_t e = listStart[lane]; e < listStart[lane + 1]; ++e) {
            if (arrives(entries[e], via, length - entries[e].front)) return true;
        }
        if (length > yieldReach) continue;
        for (std::uint32_t before : net.ways[lane].previous) {
            const double further = length + net.ways[before].length;
            for (std::uint32_t e = listStart[before]; e < listStart[before + 1]; ++e) {
                if (entries[e].front > net.ways[before].length) continue;
                if (arrives(entries[e], via, further - entries[e].front)) return true;
            }
        }
    }
    return false;
}

/// Whether the vehicle will find space behind the end of the zones, together with those ahead of it that
/// still have to get there.
bool Traffic::State::roomBehind(const Vehicle& v, std::uint32_t index, double groupEnd) const {
    double needed = v.length + standingGap;
    double lastRear =
        v.front;  // vehicles show up in several ways' lists; each lies further on than the one before
    std::uint32_t last = index;
    for (std::size_t i = v.current; i < v.path.size(); ++i) {
        const double start = v.starts[i];
        if (start > groupEnd + needed + 60) break;
        const std::uint32_t w = v.path[i];
        for (std::uint32_t e = i == v.current ? v.entry + 1 : listStart[w]; e < listStart[w + 1]; ++e) {
            const Entry& entry = entries[e];
            if (entry.vehicle == index || entry.vehicle == last) continue;
            const Vehicle& u = vehicles[entry.vehicle];
            const double rear = start + entry.front - u.length;
            if (start + entry.front < lastRear) continue;
            last = entry.vehicle;
            lastRear = rear;
            if (rear < groupEnd) {
                // Whoever is still within the crossing must be free to leave it, or what is granted here
                // would lock it in.
                const double front = start + entry.front;
                const double itsStop = u.stopIsPlan ? 1e18 : front + u.nextStop - u.front;
                const bool frontHere = front < v.starts[i + 1];
                const std::uint32_t itsNext =
                    frontHere ? (u.current + 1 < u.path.size() ? u.path[u.current + 1] : city::noIndex)
                              : u.path[u.current];
                bool together = entry.ghost;
                for (std::size_t k = i + 1; k < v.path.size() && k < i + 8; ++k)
                    together = together || v.path[k] == itsNext;
                const double mustReach =
                    together ? groupEnd : std::min(groupEnd, v.starts[i + 1]) + (frontHere ? 1e-3 : u.length);
                if (itsStop < mustReach) return false;
                if (!together) continue;
            }
            if (rear < groupEnd) {
                needed += u.length + standingGap;
                continue;
            }
            // It comes to rest no sooner than this, unless it brakes harder than anybody likes to.
            const double rest = rear + u.speed * u.speed / (2 * 3.0);
            return rest >= groupEnd + needed;
        }
    }
    return true;
}

void Traffic::State::release(Vehicle& v) {
    const double rear = v.rear();
    std::size_t kept = 0;
    for (const ZoneHold& hold : v.holds) {
        if (hold.end < rear)
            --zones[hold.zone].holders[hold.side];
        else
            v.holds[kept++] = hold;
    }
    v.holds.resize(kept);
}

}  // namespace vehicles
