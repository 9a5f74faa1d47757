#include "app/frame/EyeAdaptation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace app {

namespace {

constexpr int azimuths = 24;
// Tangents of elevations: the road ahead, its kerbs, fronts of shops, upper storeys.
constexpr std::array<float, 4> rises{-0.4f, -0.12f, 0.08f, 0.3f};
// Beyond, haze and the width of a picture leave little to meter.
constexpr float farthest = 150;  // metres
// Share of the sky's light that reaches a surface between houses, as the pictures have it in the middle of a
// street.
constexpr double openBetweenHouses = 0.45;
// A sunlit avenue meters so much of an open place in the sun: its exposure is the hour's own.
constexpr double sunlitStreet = 0.6;
// How far the exposure makes up for what light is missing: all of it would show shade as bright as sun.
constexpr double compensation = 0.8;

constexpr double secondsToAdapt = 0.8;  // to 1/e: a camera's, not an eye's minutes
constexpr double cutDistance = 15;      // metres in a frame: no vehicle moves so far, a cut does
// A factor on exposure below which no 8 bit display value changes by more than half a step: 1/2 of 1/255,
// where the display's curve is steepest against the logarithm of radiance (about 0.5 a factor of e).
constexpr double invisible = 1.0 / 255;

double luminance(const glm::vec3& colour) {
    return glm::dot(glm::dvec3(colour), glm::dvec3(0.2126, 0.7152, 0.0722));
}

}  // namespace

double exposureAround(const reflection::GridTracer& tracer, const Lighting& lighting, const glm::dvec3& eye) {
    const glm::vec3 from(eye);
    const glm::vec3 sun = lighting.sunDirection;
    const double direct = luminance(lighting.sunIrradiance), sky = luminance(lighting.skyIrradiance);
    const double inTheOpen = sky + direct * std::max(sun.z, 0.f);
    if (!std::isfinite(from.x + from.y + from.z + sun.x + sun.y + sun.z) || !std::isfinite(inTheOpen) ||
        inTheOpen <= 0)
        return 1;

    double sum = 0;
    for (int a = 0; a < azimuths; ++a) {
        const float angle = 2 * std::numbers::pi_v<float> * static_cast<float>(a) / azimuths;
        for (const float rise : rises) {
            const glm::vec3 way(std::cos(angle), std::sin(angle), rise);
            const reflection::TraceResult hit = tracer.trace({from, way}, farthest);
            double light = inTheOpen;
            if (hit.status == reflection::TraceStatus::hit) {
                // A step back, in the air before what was hit.
                const glm::vec3 before = from + way * std::max(hit.t - 0.3f, 0.f);
                const reflection::TraceResult below = tracer.trace({before, {0, 0, -1}}, 1);
                const bool ground = rise < 0 && below.status == reflection::TraceStatus::hit;
                // A wall is taken to face the eye.
                const float facing = ground ? sun.z : -(way.x * sun.x + way.y * sun.y);
                light = sky * openBetweenHouses;
                if (facing > 0 && !tracer.occluded(before, before + sun * 1000.f, 0))
                    light += direct * static_cast<double>(facing);
            }
            sum += std::log(std::max(light / inTheOpen, 1e-3));
        }
    }
    const double seen = std::exp(sum / static_cast<double>(azimuths * rises.size()));
    return std::clamp(std::pow(sunlitStreet / seen, compensation), 1.0, longestExposure);
}

double EyeAdaptation::follow(double wanted, const glm::dvec3& eye, double seconds) {
    if (!(wanted > 0) || !std::isfinite(wanted)) wanted = 1;
    if (!last_ || !(glm::distance(last_->eye, eye) < cutDistance)) {
        last_ = Seen{eye, wanted};
        return wanted;
    }
    last_->eye = eye;
    const double toGo = std::log(wanted / last_->exposure);
    const double step = seconds > 0 ? -std::expm1(-seconds / secondsToAdapt) : 0;
    if (std::abs(toGo) > invisible) last_->exposure *= std::exp(step * toGo);
    return last_->exposure;
}

}  // namespace app
