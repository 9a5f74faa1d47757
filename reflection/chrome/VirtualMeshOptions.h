#pragma once

#include <cstdint>
#include <glm/vec3.hpp>

#include "reflection/chrome/VirtualOptions.h"

namespace reflection {

struct VirtualMeshOptions {
    VirtualOptions vertices = {};
    /// Angle, seen from the eye, by which the middle of a reflected edge may lie off that of the straight one
    /// that is drawn in its place: half a pixel of a 720-row view of 60 degrees.
    double tolerance = 0.5 * 1.155 / 720;
    /// An edge is halved no more often than this.
    int mostHalvings = 6;
    /// Half the angle of a cone around `towards` from the eye outside of which nothing is drawn, so that
    /// edges there stay as they are; by default everything is.
    glm::dvec3 towards{1, 0, 0};
    double coneCosine = -2;
};

/// A vertex that was put on an edge.
struct MiddleVertex {
    std::uint32_t a, b;  ///< vertices before it, of the mesh or middles themselves
    float share = 0.5f;  ///< of the way from a to b
};

}  // namespace reflection
