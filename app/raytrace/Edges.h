#pragma once

#include <vector>

#include "app/raytrace/RayTracer.h"

namespace app {

/// The pixels near which what is seen breaks off, where two renderers may differ by a rounding of an outline:
/// 1, all others 0. A break lies between neighbours (four of each pixel) that show different kinds of things,
/// vehicles or surfaces, whose normals differ by more than 10 degrees, or of which one lies more than 1 % of
/// its distance from the other's plane. Everything within `radius` pixels (a square) of either is marked.
std::vector<unsigned char> edgesOf(const TracedPicture& picture, const View& view, int radius = 1);

}  // namespace app
