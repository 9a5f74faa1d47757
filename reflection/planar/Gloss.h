#pragma once

namespace reflection {

/// The spread of light that a rough mirror sends to the eye: standard deviation, radians, of the reflected
/// direction within the plane of incidence, for microfacets whose slopes have a standard deviation of
/// roughness^2 / sqrt(2) on each axis (Beckmann's distribution with alpha = roughness^2, which GGX resembles
/// but for its tails): a mirror turned by an angle turns the reflection by twice that. Across the plane of
/// incidence it is cos(incidence) times as much. From the eye behind the glass, of something a share of the
/// way behind it, it is that share of this angle: nothing at the glass, all of it far away. This is why a
/// rough mirror is sharp where things touch it. Precondition: 0 <= roughness <= 1.
inline double glossAngle(double roughness) {
    return 1.4142135623730951 * roughness * roughness;
}

}  // namespace reflection
