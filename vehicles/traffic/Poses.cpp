#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "vehicles/traffic/TrafficState.h"

namespace vehicles {

namespace {

struct Paint {
    glm::vec3 colour;  ///< linear RGB
    float share;       ///< of new cars in Europe, roughly
};

constexpr std::array<Paint, 12> carPaints{{
    {{0.80f, 0.80f, 0.78f}, 24},     // white
    {{0.012f, 0.012f, 0.014f}, 20},  // black
    {{0.10f, 0.105f, 0.11f}, 16},    // dark grey
    {{0.24f, 0.25f, 0.26f}, 11},     // grey
    {{0.50f, 0.51f, 0.52f}, 10},     // silver
    {{0.02f, 0.06f, 0.22f}, 7},      // blue
    {{0.012f, 0.03f, 0.08f}, 4},     // night blue
    {{0.40f, 0.02f, 0.02f}, 5},      // red
    {{0.14f, 0.012f, 0.02f}, 1},     // wine red
    {{0.03f, 0.10f, 0.06f}, 1},      // green
    {{0.35f, 0.27f, 0.17f}, 1},      // beige
    {{0.62f, 0.33f, 0.03f}, 0.7f},   // yellow
}};
constexpr glm::vec3 tramLivery{0.05f, 0.26f, 0.13f};
constexpr glm::vec3 busLivery{0.03f, 0.11f, 0.36f};
constexpr float busLength = 9;  // metres; longer road vehicles wear their company's colours

glm::vec3 paintOf(const VehicleKind& kind, std::uint64_t seed) {
    if (kind.tram) return tramLivery;
    if (kind.length > busLength) return busLivery;
    float sum = 0;
    for (const Paint& paint : carPaints) sum += paint.share;
    SeededRandom random{seed};
    auto x = static_cast<float>(random.unit()) * sum;
    for (const Paint& paint : carPaints) {
        x -= paint.share;
        if (x < 0) return paint.colour;
    }
    return carPaints.front().colour;
}

double wrapped(double angle) {
    while (angle > std::numbers::pi) angle -= 2 * std::numbers::pi;
    while (angle < -std::numbers::pi) angle += 2 * std::numbers::pi;
    return angle;
}

}  // namespace

void Traffic::State::updatePoses() {
    const bool first = poses.size() != vehicles.size();
    poses.resize(vehicles.size());
    for (std::uint32_t i = 0; i < vehicles.size(); ++i) {
        const Vehicle& v = vehicles[i];
        const VehicleKind& kind = kinds[v.kind];
        VehiclePose& pose = poses[i];
        if (first || pose.id != v.id) {
            pose.id = v.id;
            pose.model = v.kind;
            pose.paint = paintOf(kind, options.seed * 31 + v.id);
        }
        const auto at = [&](double odometer) {
            std::size_t k = v.current;
            while (k > 0 && v.starts[k] > odometer) --k;
            const std::uint32_t w = v.path[k];
            const double s = odometer - v.starts[k];
            const glm::dvec3 p = net.pointAt(w, s);
            if (v.changeFrom == city::noIndex || k != v.current) return p;
            // Crossing over: a smooth step from the old lane's line to the new one's.
            const double t = std::clamp((odometer - v.changeStart) / v.changeLength, 0.0, 1.0);
            const double part = t * t * t * (10 + t * (6 * t - 15));
            return (1 - part) * net.pointAt(v.changeFrom, s * v.changeScale) + part * p;
        };
        const double overhang = 0.5 * (kind.length - kind.wheelbase);
        const double frontAxle = v.front - overhang;
        const glm::dvec3 f = at(frontAxle);
        const glm::dvec3 r = at(frontAxle - kind.wheelbase);
        const glm::dvec3 d = f - r;
        const double run = std::hypot(d.x, d.y);
        pose.position = 0.5 * (f + r);
        if (run > 1e-6) {
            pose.heading = std::atan2(d.y, d.x);
            pose.pitch = std::atan2(d.z, run);
        }
        const glm::dvec3 ahead = at(frontAxle + 0.6) - f;
        pose.steering = std::hypot(ahead.x, ahead.y) > 1e-6
                            ? static_cast<float>(
                                  std::clamp(wrapped(std::atan2(ahead.y, ahead.x) - pose.heading), -0.7, 0.7))
                            : 0.0f;
        pose.speed = static_cast<float>(v.speed);
        pose.wheelAngle = static_cast<float>(v.wheelAngle);
        pose.braking = v.acceleration < -0.5 || v.speed < 0.05;
    }
}

}  // namespace vehicles
