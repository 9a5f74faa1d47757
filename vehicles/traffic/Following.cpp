#include <algorithm>
#include <cmath>

#include "vehicles/traffic/TrafficState.h"

namespace vehicles {

namespace {

constexpr double headway = 1.2;           // seconds; IDM's T
constexpr double restGap = 1.8;           // metres between standing vehicles; IDM's s0
constexpr double changeIncentive = 0.25;  // m/s^2 that a change must gain (MOBIL)
constexpr double politeness = 0.3;        // weight of what the new follower loses
constexpr double safeBraking = 2.0;       // m/s^2 that the new follower may have to brake
constexpr double changeTime = 3.5;        // seconds

}  // namespace

/// Nearest vehicle ahead on the planned path: in the ways' own lists, and on stretches shared with other
/// ways.
Leader Traffic::State::leaderOf(const Vehicle& v, std::uint32_t index, double reach) const {
    Leader best;
    const auto take = [&](double gap, std::uint32_t u) {
        if (gap < best.gap) best = {gap, vehicles[u].speed, u};
    };
    for (std::size_t i = v.current; i < v.path.size(); ++i) {
        const double start = v.starts[i];
        if (start - v.front > reach || best.vehicle != city::noIndex) break;
        const std::uint32_t w = v.path[i];
        const double here = v.front - start;  // negative on ways ahead
        for (std::uint32_t e = i == v.current ? v.entry + 1 : listStart[w]; e < listStart[w + 1]; ++e) {
            const Entry& u = entries[e];
            if (u.vehicle == index) continue;
            take(u.front - vehicles[u.vehicle].length - here, u.vehicle);
            break;
        }
        for (const Way::Shared& shared : net.ways[w].shared) {
            if (here > shared.end) continue;
            const double otherEnd = shared.otherBegin + (shared.end - shared.begin) * shared.scale;
            for (std::uint32_t e = listStart[shared.other]; e < listStart[shared.other + 1]; ++e) {
                const Entry& u = entries[e];
                if (u.vehicle == index) continue;
                const double uRear = u.front - vehicles[u.vehicle].length;
                if (uRear > otherEnd || u.front < shared.otherBegin) continue;
                const double front = shared.begin + (u.front - shared.otherBegin) / shared.scale;
                if (front < here || (front == here && u.vehicle < index)) continue;
                take(front - vehicles[u.vehicle].length - here, u.vehicle);
            }
        }
    }
    if (v.changeFrom != city::noIndex) {
        const double here = (v.front - v.starts[v.current]) * v.changeScale;
        for (std::uint32_t e = listStart[v.changeFrom]; e < listStart[v.changeFrom + 1]; ++e) {
            const Entry& u = entries[e];
            if (u.vehicle == index || u.front <= here) continue;
            take(u.front - vehicles[u.vehicle].length - here, u.vehicle);
            break;
        }
    }
    return best;
}

double Traffic::State::freeSpeed(const Vehicle& v) const {
    const double reach = 10 + v.speed * v.speed / 3;
    double wanted = net.speedAt(v.path[v.current], v.front - v.starts[v.current]);
    for (std::size_t i = v.current + 1; i < v.path.size() && v.starts[i] - v.front < reach; ++i) {
        const double entry = net.speeds[net.ways[v.path[i]].firstSample];
        wanted = std::min(wanted, std::sqrt(entry * entry + 3.0 * (v.starts[i] - v.front)));
    }
    return std::max(0.5, wanted * v.temper);
}

/// The intelligent driver model (Treiber, Hennecke, Helbing 2000). Above the wanted speed it eases off in
/// proportion instead of with the fourth power, which would brake too hard before bends.
double Traffic::State::follow(const Vehicle& v, double wanted, double gap, double leaderSpeed) const {
    const VehicleKind& kind = kinds[v.kind];
    const double a = kind.acceleration;
    const double b = kind.deceleration;
    const double ratio = v.speed / wanted;
    double acceleration =
        ratio <= 1 ? a * (1 - ratio * ratio * ratio * ratio) : -b * std::min(1.5, 4 * (ratio - 1));
    if (gap < 1e8) {
        const double s = std::max(0.05, gap);
        const double closing = v.speed - leaderSpeed;
        const double target =
            restGap + std::max(0.0, v.speed * headway + v.speed * closing / (2 * std::sqrt(a * b)));
        acceleration = std::min(acceleration, a * (1 - (target / s) * (target / s)));
    }
    return std::clamp(acceleration, -hardestBraking, a);
}

/// MOBIL (Kesting, Treiber, Helbing 2007): change where it gains and the new follower need not brake hard. A
/// change is done before the lane ends, and only where neither lane meets another way.
bool Traffic::State::changeLanes(std::uint32_t index) {
    Vehicle& v = vehicles[index];
    const std::uint32_t w = v.path[v.current];
    const Way& way = net.ways[w];
    if (v.changeFrom != city::noIndex || way.connection || way.tram || v.speed < 3) return false;
    if (way.left == city::noIndex && way.right == city::noIndex) return false;
    const double s = v.front - v.starts[v.current];
    const double distance = std::max(12.0, changeTime * v.speed);
    if (s < v.length + 15 || s + distance + v.length + 8 > way.length) return false;
    // What is granted beyond this lane's end is planned from this lane.
    if (v.granted > v.starts[v.current + 1] || !v.holds.empty()) return false;
    const auto clear = [&](const Way& lane, double from, double to) {
        return lane.shared.empty() &&
               std::none_of(lane.zones.begin(), lane.zones.end(),
                            [&](const Way::ZoneSide& z) { return z.begin < to && z.end > from; });
    };
    const Leader ahead = leaderOf(v, index, 80);
    const double wanted = freeSpeed(v);
    const double now = follow(v, wanted, ahead.gap, ahead.speed);
    for (const std::uint32_t side : {way.left, way.right}) {
        // The lists do not know yet who changed in this substep.
        if (side == city::noIndex || changedAt[side] == substeps || changedAt[w] == substeps) continue;
        const Way& lane = net.ways[side];
        const double scale = lane.length / way.length;
        const double there = s * scale;
        if (!clear(way, s - v.length, s + distance + v.length + 8) ||
            !clear(lane, there - v.length - 2, there + distance + v.length + 8)) {
            continue;
        }
        double gapAhead = 1e9;
        double speedAhead = 0;
        double gapBehind = 1e9;
        std::uint32_t behind = city::noIndex;
        for (std::uint32_t e = listStart[side]; e < listStart[side + 1]; ++e) {
            const Entry& u = entries[e];
            if (u.front < there) {
                gapBehind = there - v.length - u.front;
                behind = u.vehicle;
            } else {
                gapAhead = u.front - vehicles[u.vehicle].length - there;
                speedAhead = vehicles[u.vehicle].speed;
                break;
            }
        }
        if (gapAhead < restGap + 0.5 * v.speed || gapBehind < restGap + 1) continue;
        double loss = 0;
        if (behind != city::noIndex) {
            const Vehicle& f = vehicles[behind];
            const double then = follow(f, std::max(0.5, wanted), gapBehind, v.speed);
            if (then < -safeBraking) continue;
            loss = std::max(0.0, f.acceleration - then);
        }
        const double gain = follow(v, wanted, gapAhead, speedAhead) - now - politeness * loss;
        // Keeping right costs less than keeping left.
        if (gain < changeIncentive + (side == way.left ? 0.0 : -0.1)) continue;
        v.changeFrom = w;
        v.changeStart = v.front;
        v.changeLength = distance;
        v.changeScale = 1 / scale;
        const double start = v.front - there;
        v.path.assign(1, side);
        v.starts = {start, start + lane.length};
        v.current = 0;
        v.granted = std::min(v.granted, v.front);
        findNextStop(v);
        changedAt[w] = substeps;
        changedAt[side] = substeps;
        return true;
    }
    return false;
}

}  // namespace vehicles
