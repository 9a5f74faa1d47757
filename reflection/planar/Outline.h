#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "reflection/planar/EyeView.h"

namespace reflection {

/// Where a polygon falls in a perspective view's image, in normalised device coordinates; its corners are
/// relative to the eye. Empty where a corner has no place: beside or behind the eye.
std::vector<glm::dvec2> projected(const EyeView& view, const std::vector<glm::dvec3>& relative);

/// A convex polygon whose sides have moved out by `margin` texels; `texels`: for one unit of its coordinates,
/// x and y. Either winding. Corners sharper than a right angle are cut off, no nearer than the margin. Empty
/// where it has no three distinct corners.
std::vector<glm::dvec2> widened(const std::vector<glm::dvec2>& polygon, const glm::dvec2& texels,
                                double margin);

}  // namespace reflection
