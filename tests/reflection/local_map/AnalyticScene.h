#pragma once

#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <limits>

#include "reflection/local_map/ReferenceLookup.h"
#include "reflection/reference_maps/CubeMapping.h"
#include "reflection/reference_maps/PackedReferenceMap.h"

namespace reflection {

/// What a ray meets, by formula.
struct SceneHit {
    double t = std::numeric_limits<double>::infinity();  ///< in units of the direction
    int surface = -1;                                    ///< -1: sky
    glm::dvec3 colour{0};
};

using Scene = std::function<SceneHit(const glm::dvec3& from, const glm::dvec3& direction)>;

/// Brightness that changes smoothly with the place: its relative slope is below 0.12 * 2 pi / 80 / 0.38 = 2.5
/// % a metre.
inline double brightnessAt(const glm::dvec3& p) {
    return 0.5 + 0.12 * std::sin(2 * 3.14159265358979 / 80 * glm::dot(p, glm::dvec3(0.6, 0.64, 0.48)));
}

/// A street along y: ground at z = 0, walls at x = -8 and x = 9, 14 m high, sky above; each surface of a tint
/// of its own.
inline SceneHit streetScene(const glm::dvec3& from, const glm::dvec3& d) {
    SceneHit hit;
    const auto take = [&](double t, int surface, double low, double high) {
        const glm::dvec3 p = from + t * d;
        if (t > 0 && t < hit.t && p.z >= low && p.z <= high) {
            hit.t = t;
            hit.surface = surface;
        }
    };
    if (d.z < 0) take(-from.z / d.z, 0, -1, 1);
    if (d.x < 0) take((-8 - from.x) / d.x, 1, 0, 14);
    if (d.x > 0) take((9 - from.x) / d.x, 2, 0, 14);
    constexpr glm::dvec3 tints[] = {{0.4, 0.35, 0.25}, {0.6, 0.25, 0.15}, {0.2, 0.3, 0.5}};
    hit.colour = hit.surface < 0
                     ? glm::dvec3(0.5, 0.7, 1.1)
                     : tints[static_cast<std::size_t>(hit.surface)] * (3 * brightnessAt(from + hit.t * d));
    return hit;
}

/// A closed room of 12 x 20 x 7 m around the origin's neighbourhood; one tint.
inline SceneHit roomScene(const glm::dvec3& from, const glm::dvec3& d) {
    SceneHit hit;
    constexpr glm::dvec3 low(-5, -9, -2), high(7, 11, 5);
    for (int axis = 0; axis < 3; ++axis) {
        if (d[axis] == 0) continue;
        const double t = ((d[axis] > 0 ? high[axis] : low[axis]) - from[axis]) / d[axis];
        if (t < hit.t) {
            hit.t = t;
            hit.surface = 2 * axis + (d[axis] > 0 ? 1 : 0);
        }
    }
    hit.colour = glm::dvec3(0.45, 0.33, 0.22) * (3 * brightnessAt(from + hit.t * d));
    return hit;
}

/// The map that a perfect renderer would make.
inline PackedReferenceMap mapOf(const Scene& scene, const glm::dvec3& centre, int faceSize,
                                float radianceScale = 8) {
    ReferenceMap map;
    map.position = centre;
    map.faceSize = faceSize;
    for (int face = 0; face < 6; ++face)
        for (int y = 0; y < faceSize; ++y)
            for (int x = 0; x < faceSize; ++x) {
                const glm::dvec3 d(cubeDirection(face, glm::vec2(x, y) + 0.5f, faceSize));
                const SceneHit hit = scene(centre, d);
                map.colour.emplace_back(hit.colour);
                map.distance.push_back(static_cast<float>(hit.t * glm::length(d)));
            }
    return PackedReferenceMap(map, radianceScale);
}

/// Whether a map's texels within `margin` around the direction to a point all show this surface, so that no
/// silhouette blends in.
inline bool isClean(const Scene& scene, const glm::dvec3& centre, const glm::dvec3& point, int surface,
                    int faceSize, double margin) {
    const glm::dvec3 to = point - centre;
    const CubePoint at = cubePoint(glm::vec3(to));
    for (int v = -1; v <= 1; ++v)
        for (int u = -1; u <= 1; ++u) {
            const glm::vec2 st = at.st + glm::vec2(u, v) * static_cast<float>(2 * margin / faceSize);
            if (scene(centre, glm::dvec3(cubeDirection(at.face, (st + 1.0f) * 0.5f, 1))).surface != surface)
                return false;
        }
    return true;
}

}  // namespace reflection
