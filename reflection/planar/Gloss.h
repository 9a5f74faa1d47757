#pragma once

namespace reflection {

/// The spread of light that a rough mirror sends to the eye: standard deviation, radians, of the reflected
/// direction within the plane of incidence, for microfacets whose slopes have a standard deviation of
/// roughness^2 / sqrt(2) on each axis (Beckmann's distribution with alpha = roughness^2, which GGX resembles
/// but for its tails): a mirror turned by an angle turns the reflection by twice that. Across the plane of
/// incidence it is cos(incidence) times as much. Precondition: 0 <= roughness <= 1.
inline double glossAngle(double roughness) {
    return 1.4142135623730951 * roughness * roughness;
}

/// The same as seen from the eye behind the glass, `before` metres from the mirror, of something `behind`
/// metres behind it: nothing at the glass, all of it far away. This is why a rough mirror is sharp where
/// things touch it. Defined (0) where both are 0. Preconditions: not negative.
inline double glossAngleSeen(double angle, double before, double behind) {
    const double way = before + behind;
    return way > 0 ? angle * (behind / way) : 0;
}

}  // namespace reflection
