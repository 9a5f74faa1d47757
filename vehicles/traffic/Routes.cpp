#include <algorithm>
#include <cmath>

#include "vehicles/traffic/TrafficState.h"

namespace vehicles {

std::uint64_t SeededRandom::next() {
    state += 0x9e3779b97f4a7c15ULL;
    std::uint64_t z = state;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31);
}

double SeededRandom::unit() {
    return static_cast<double>(next() >> 11) * 0x1p-53;
}

std::uint32_t SeededRandom::below(std::uint32_t n) {
    return std::min(n - 1, static_cast<std::uint32_t>(unit() * n));
}

/// Plans on until the path reaches the odometer reading. More go straight on than turn.
void Traffic::State::extend(Vehicle& v, double odometer) {
    while (v.starts.back() < odometer) {
        const Way& last = net.ways[v.path.back()];
        if (last.next.empty()) return;
        std::uint32_t choice = last.next.front();
        if (last.next.size() > 1) {
            double sum = 0;
            const auto weight = [&](std::uint32_t w) {
                const double turn = std::abs(net.ways[w].turn);
                return turn < 0.6 ? 2.0 : turn < 2.4 ? 1.0 : 0.2;
            };
            for (std::uint32_t w : last.next) sum += weight(w);
            double x = v.random.unit() * sum;
            for (std::uint32_t w : last.next) {
                x -= weight(w);
                choice = w;
                if (x < 0) break;
            }
        }
        v.path.push_back(choice);
        v.starts.push_back(v.starts.back() + net.ways[choice].length);
    }
}

/// Forgets what is planned beyond the way under the front.
void Traffic::State::shorten(Vehicle& v) {
    v.path.resize(v.current + 1);
    v.starts.resize(v.current + 2);
}

void Traffic::State::dropPassed(Vehicle& v) {
    while (v.current + 1 < v.path.size() && v.front >= v.starts[v.current + 1]) ++v.current;
    std::size_t passed = 0;
    while (passed < v.current && v.starts[passed + 1] < v.rear() - 2) ++passed;
    if (passed == 0) return;
    v.path.erase(v.path.begin(), v.path.begin() + static_cast<std::ptrdiff_t>(passed));
    v.starts.erase(v.starts.begin(), v.starts.begin() + static_cast<std::ptrdiff_t>(passed));
    v.current -= static_cast<std::uint32_t>(passed);
}

}  // namespace vehicles
