#include "vehicles/traffic/Traffic.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "vehicles/traffic/TrafficState.h"

namespace vehicles {

namespace {

constexpr double longestSubstep = 0.125;     // seconds; a driver's reaction is several times this
constexpr double stopLineSetback = 0.4;      // metres before a stop where drivers come to rest
constexpr double longestStand = 150;         // seconds; longer than any cycle of signals
constexpr std::uint64_t relocateEvery = 64;  // substeps between two looks for knots
constexpr std::uint64_t changeEvery = 12;    // substeps between two thoughts of changing lanes

std::vector<VehicleKind> checked(std::vector<VehicleKind> kinds, const TrafficOptions& options) {
    if (kinds.empty())
        throw std::invalid_argument("Traffic: the list of vehicle kinds is empty; give at least one.");
    if (!std::isfinite(options.step) || options.step <= 0) {
        throw std::invalid_argument("Traffic: the step must be a positive number of seconds, not " +
                                    std::to_string(options.step) + ".");
    }
    for (std::size_t i = 0; i < kinds.size(); ++i) {
        VehicleKind& kind = kinds[i];
        const bool sound = std::isfinite(kind.length) && kind.length > 0.5f && kind.length < 100 &&
                           std::isfinite(kind.width) && kind.width > 0.2f && kind.width < 10 &&
                           std::isfinite(kind.wheelbase) && kind.acceleration > 0.01f &&
                           kind.deceleration > 0.01f && std::isfinite(kind.acceleration) &&
                           std::isfinite(kind.deceleration);
        if (!sound) {
            throw std::invalid_argument(
                "Traffic: kind " + std::to_string(i) +
                " has a size or acceleration that no vehicle has; lengths are metres.");
        }
        kind.wheelbase = std::clamp(kind.wheelbase, 0.3f * kind.length, 0.95f * kind.length);
    }
    return kinds;
}

}  // namespace

Traffic::State::State(const city::RoadNetwork& network, std::vector<VehicleKind> vehicleKinds,
                      const TrafficOptions& wanted)
    : roads(&network), kinds(checked(std::move(vehicleKinds), wanted)), options(wanted), net(network, kinds) {
    zones.resize(net.zoneCount);
    phase.assign(network.junctions.size(), 0);
    changedAt.assign(net.ways.size(), ~0ULL);
    place();
    updatePoses();
}

/// Every vehicle into the list of every way that its body is on.
void Traffic::State::listVehicles() {
    listStart.assign(net.ways.size() + 1, 0);
    const auto forWays = [&](const auto& visit) {
        for (std::uint32_t i = 0; i < vehicles.size(); ++i) {
            const Vehicle& v = vehicles[i];
            for (std::size_t k = 0; k <= v.current; ++k) {
                if (v.starts[k + 1] >= v.rear() - bumperGap)
                    visit(v.path[k], Entry{v.front - v.starts[k], i, false});
            }
            if (v.changeFrom != city::noIndex) {
                visit(v.changeFrom, Entry{(v.front - v.starts[v.current]) * v.changeScale, i, true});
            }
        }
    };
    forWays([&](std::uint32_t w, const Entry&) { ++listStart[w + 1]; });
    for (std::size_t w = 1; w < listStart.size(); ++w) listStart[w] += listStart[w - 1];
    entries.resize(listStart.back());
    fill.assign(listStart.begin(), listStart.end() - 1);
    forWays([&](std::uint32_t w, const Entry& e) {
        // Insertion: a way holds few vehicles, and their order seldom changes.
        std::uint32_t at = fill[w]++;
        while (at > listStart[w] &&
               (entries[at - 1].front > e.front ||
                (entries[at - 1].front == e.front && entries[at - 1].vehicle > e.vehicle))) {
            entries[at] = entries[at - 1];
            --at;
        }
        entries[at] = e;
    });
    order.clear();
    for (std::size_t w = 0; w + 1 < listStart.size(); ++w) {
        for (std::uint32_t e = listStart[w + 1]; e-- > listStart[w];) {
            Vehicle& v = vehicles[entries[e].vehicle];
            if (entries[e].ghost || v.path[v.current] != w ||
                entries[e].front != v.front - v.starts[v.current])
                continue;
            v.entry = e;
            order.push_back(entries[e].vehicle);
        }
    }
}

void Traffic::State::move(double dt) {
    newFront.resize(vehicles.size());
    newSpeed.resize(vehicles.size());
    for (std::uint32_t i : order) {
        Vehicle& v = vehicles[i];
        const double reach = 25 + 4 * v.speed;
        const Leader leader = leaderOf(v, i, reach);
        const double wanted = freeSpeed(v);
        double acceleration = follow(v, wanted, leader.gap, leader.speed);
        const double toStop = v.stopIsPlan ? 1e9 : v.nextStop - v.front;
        if (toStop < reach) {
            // A stop is a standing leader that one may come close to: the gap at rest is put behind it.
            acceleration = std::min(acceleration, follow(v, wanted, toStop + 1.8 - stopLineSetback, 0));
        }
        const double speed = std::max(0.0, v.speed + acceleration * dt);
        double way = 0.5 * (v.speed + speed) * dt;
        if (v.speed + acceleration * dt < 0) way = 0.5 * v.speed * v.speed / -acceleration;
        // Whatever the model says: never into the one ahead (it only moves forward) nor over what is not
        // granted.
        const double most = std::max(0.0, std::min(leader.gap - bumperGap, toStop));
        newFront[i] = v.front + std::min(way, most);
        newSpeed[i] = way > most ? std::min(speed, most / dt) : speed;
        v.acceleration = (newSpeed[i] - v.speed) / dt;
    }
    for (std::uint32_t i : order) {
        Vehicle& v = vehicles[i];
        const double step = newFront[i] - v.front;
        v.front = newFront[i];
        v.speed = newSpeed[i];
        v.wheelAngle =
            std::fmod(v.wheelAngle + step / std::max(0.05f, kinds[v.kind].wheelRadius), 2 * std::numbers::pi);
        if (v.changeFrom != city::noIndex && v.rear() > v.changeStart + v.changeLength)
            v.changeFrom = city::noIndex;
        dropPassed(v);
        release(v);
    }
}

void Traffic::State::stepOnce(double dt) {
    for (std::size_t j = 0; j < phase.size(); ++j) {
        const city::Signal& signal = roads->junctions[j].signal;
        double cycle = 0;
        for (const city::SignalPhase& p : signal.phases) cycle += std::max(0.0f, p.duration);
        if (!(cycle > 0)) continue;
        double t = std::fmod(time - signal.offset, cycle);
        if (t < 0) t += cycle;
        std::uint32_t k = 0;
        while (k + 1 < signal.phases.size() && t >= signal.phases[k].duration)
            t -= signal.phases[k++].duration;
        phase[j] = k;
    }
    listVehicles();
    if (substeps % relocateEvery == relocateEvery - 1) {
        for (std::uint32_t i = 0; i < vehicles.size(); ++i) {
            const Vehicle& v = vehicles[i];
            if (v.stood > longestStand && v.refusal != Refusal::none && v.nextStop - v.front < 3) relocate(i);
        }
    }
    bool changed = false;
    for (std::uint32_t i = 0; i < vehicles.size(); ++i) {
        if ((i + substeps) % changeEvery == 0) changed = changeLanes(i) || changed;
    }
    if (changed) listVehicles();
    for (std::uint32_t i : order) askForWay(i, dt);
    move(dt);
    time += dt;
    ++substeps;
}

SignalColour Traffic::State::colour(std::uint32_t junction, std::uint32_t group) const {
    const city::Signal& signal = roads->junctions[junction].signal;
    if (signal.phases.empty()) return SignalColour::green;
    const city::SignalPhase& now = signal.phases[phase[junction]];
    if (std::find(now.greenGroups.begin(), now.greenGroups.end(), group) == now.greenGroups.end())
        return SignalColour::red;
    return now.amber ? SignalColour::amber : SignalColour::green;
}

Traffic::Traffic(const city::RoadNetwork& roads, std::vector<VehicleKind> kinds,
                 const TrafficOptions& options)
    : state_(std::make_unique<State>(roads, std::move(kinds), options)) {}
Traffic::~Traffic() = default;
Traffic::Traffic(Traffic&&) noexcept = default;
Traffic& Traffic::operator=(Traffic&&) noexcept = default;

void Traffic::step() {
    const double dt = state_->options.step;
    const int parts = static_cast<int>(std::ceil(dt / longestSubstep - 1e-9));
    for (int i = 0; i < std::max(1, parts); ++i) state_->stepOnce(dt / std::max(1, parts));
    ++state_->steps;
    state_->time = static_cast<double>(state_->steps) * dt;
    state_->updatePoses();
}

double Traffic::time() const {
    return state_->time;
}
std::size_t Traffic::size() const {
    return state_->vehicles.size();
}
std::size_t Traffic::kindCount() const {
    return state_->kinds.size();
}
std::span<const VehiclePose> Traffic::poses() const {
    return state_->poses;
}

SignalColour Traffic::signal(std::uint32_t junction, std::uint32_t group) const {
    if (junction >= state_->phase.size()) return SignalColour::green;
    return state_->colour(junction, group);
}

std::uint64_t Traffic::stateHash() const {
    std::uint64_t hash = 0xcbf29ce484222325ULL;
    const auto mix = [&](std::uint64_t x) {
        SeededRandom r{hash ^ x};
        hash = r.next();
    };
    const auto mixReal = [&](double x) { mix(std::bit_cast<std::uint64_t>(x)); };
    mix(state_->steps);
    mixReal(state_->time);
    for (const Vehicle& v : state_->vehicles) {
        mix(v.id);
        mix(v.kind);
        mixReal(v.front);
        mixReal(v.speed);
        mixReal(v.waited);
        mixReal(v.granted);
        mixReal(v.nextStop);
        mix(v.random.state);
        mix(v.changeFrom);
        mix(v.current);
        for (std::uint32_t w : v.path) mix(w);
        for (const ZoneHold& hold : v.holds) mix(hold.zone);
    }
    for (std::uint32_t p : state_->phase) mix(p);
    return hash;
}

}  // namespace vehicles
