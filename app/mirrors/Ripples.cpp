#include "app/mirrors/Ripples.h"

#include <cmath>

namespace app {

RippleFrame::RippleFrame(const glm::dvec3& normal) {
    // Level mirrors: u east, v north. Upright ones: u along the ground.
    const glm::dvec3 other = std::abs(normal.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(0, 1, 0);
    u = glm::normalize(glm::cross(other, normal));
    v = glm::cross(normal, u);
}

glm::dvec2 rippleSlope(const Ripples& ripples, const RippleFrame& frame, const glm::dvec3& world) {
    const glm::dvec2 at(glm::dot(frame.u, world), glm::dot(frame.v, world));
    glm::dvec2 slope(0);
    for (int i = 0; i < 6; ++i) {
        // Directions 25 degrees apart, each wave 0.7 times as long as the last, phases far from each other.
        const double angle = 0.43633231 * (i - 2.5) * (i % 2 == 0 ? 1 : -1);
        const glm::dvec2 along(std::cos(angle), std::sin(angle));
        const double number = 6.283185307179586 / (ripples.wavelength * std::pow(0.7, i));
        // Six cosines of equal slope: the variance of one is half its square.
        slope +=
            ripples.slope * std::sqrt(2.0 / 6.0) * std::cos(number * glm::dot(along, at) + 2.4 * i) * along;
    }
    return slope;
}

}  // namespace app
