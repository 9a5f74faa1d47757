#include "app/frame/Lighting.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numbers>

namespace app {

namespace {

double smooth(double from, double to, double x) {
    const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
    return t * t * (3 - 2 * t);
}

}  // namespace

Lighting lightingAt(double hour, double latitude) {
    Lighting lighting;
    if (!std::isfinite(hour) || !std::isfinite(latitude)) return lighting;

    // The sun's path at the summer solstice; hour angle 0 at noon, growing westwards.
    constexpr double degree = std::numbers::pi / 180;
    constexpr double declination = 23.44 * degree;
    const double phi = std::clamp(latitude, -90.0, 90.0) * degree;
    const double hourAngle = (hour - 12) * 15 * degree;
    const glm::dvec3 sun(
        -std::cos(declination) * std::sin(hourAngle),
        std::cos(phi) * std::sin(declination) - std::sin(phi) * std::cos(declination) * std::cos(hourAngle),
        std::sin(phi) * std::sin(declination) + std::cos(phi) * std::cos(declination) * std::cos(hourAngle));
    const double elevation = std::asin(std::clamp(sun.z, -1.0, 1.0)) / degree;

    // Below 1 degree the moon takes the sun's place: shadows stay finite and night is not black.
    const double day = smooth(-4, 12, elevation);       // how much of the sky's daylight is there
    const double direct = smooth(-0.5, 14, elevation);  // how much of the sun
    // Beam through air mass m is dimmed by exp(-tau m), blue most (tau of a clear summer day).
    const double airMass =
        1 / (std::max(sun.z, 0.0) +
             0.15 * std::pow(93.885 + std::clamp(elevation, -3.0, 90.0) - 0.0, -1.253) + 0.025);
    const glm::dvec3 beam = glm::dvec3(3.05) * glm::exp(-glm::dvec3(0.09, 0.13, 0.21) * airMass);

    const glm::dvec3 nightSky(0.012, 0.016, 0.03);
    const glm::dvec3 noonSky(0.55, 0.68, 0.9);
    const glm::dvec3 duskSky(0.26, 0.24, 0.34);
    const glm::dvec3 sky = glm::mix(nightSky, glm::mix(duskSky, noonSky, smooth(0, 25, elevation)), day);

    glm::dvec3 towards = sun;
    glm::dvec3 irradiance = beam * direct;
    if (elevation < 0.5) {
        towards = glm::dvec3(0.35, -0.45, 0.82);
        irradiance = glm::dvec3(0.02, 0.024, 0.035) * (1 - smooth(-6, 0.5, elevation));
    }
    towards.z = std::max(towards.z, 0.02);
    towards = glm::normalize(towards);
    const glm::dvec3 ground = 0.2 * (sky + irradiance * towards.z);

    lighting.sunDirection = glm::normalize(glm::vec3(towards));
    lighting.sunIrradiance = glm::vec3(irradiance);
    lighting.skyIrradiance = glm::vec3(sky);
    lighting.groundIrradiance = glm::vec3(ground);
    lighting.turbidity = 3;
    // The eye opens at dusk and night, but not so far that night looks like day.
    const double level = (sky.g + irradiance.g * towards.z) / 2.4;
    lighting.exposure = static_cast<float>(std::clamp(std::pow(std::max(level, 1e-3), -0.62), 0.9, 9.0));
    lighting.lampsLit = elevation < 4;
    return lighting;
}

}  // namespace app
