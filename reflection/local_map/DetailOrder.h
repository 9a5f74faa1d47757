#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

#include "reflection/local_map/ReferenceLookup.h"
#include "reflection/reference_maps/CubeMapping.h"

namespace reflection {

/// A surface as the order of maps needs it, seen from the local map's centre: a point (metres) and the plane
/// {x : plane . x = 1} around it. A zero plane faces every map.
struct SurfacePatch {
    glm::vec3 point{0}, plane{0};
};

/// The patch around a texel, from the differences to its neighbours: 1/t = plane . d along every ray d.
/// `reciprocal`: n^2 values of 1/t over the face, 0 for sky, which is taken to lie
/// PackedReferenceMap::skyDepth away.
SurfacePatch patchAround(const CubeFace& face, const float* reciprocal, int n, int x, int y);

/// Puts the maps first that see the patch in about the detail in which the local map sees it. Of two centres
/// at distances r and s from a point, at heights 1 and h over its plane, the second sees it larger by r/s
/// across the line of sight and by h (r/s)^2 along it (the foreshortening is height over distance). A map
/// that sees it smaller in one of the two is blurred there, one that sees it larger aliases; one behind the
/// plane does not see it at all and comes last. `order` has the candidates' number of places, at most 16.
void orderByDetail(std::span<const Candidate> candidates, const SurfacePatch& patch,
                   std::span<std::uint8_t> order);

}  // namespace reflection
