#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "city/geometry/Aabb.h"
#include "reflection/planar/MirrorPlane.h"
#include "reflection/planar/Portal.h"

namespace reflection {

/// A planar reflector as the tree sees it.
struct Mirror {
    static constexpr std::uint32_t alone = 0xffffffffu;

    std::uint64_t id = 0;  ///< the caller's; not looked at
    MirrorPlane plane;
    /// Mirrors with the same number lie in one plane and may share a mirror view (see `groupCoplanar`).
    std::uint32_t group = alone;
    /// Radians by which its reflections stray besides roughness, where it is bumped: what is drawn of them is
    /// that much larger than the mirror.
    double reach = 0;
    /// Texels of its maps for each that they would have, (0, 1]: less for what is rough anyway. With
    /// `Economies::resolution`; companions have the largest of theirs.
    double texels = 1;
};

/// Numbers the groups of coplanar mirrors, from 0; those without a companion stay alone. Returns the number
/// of groups. Cost: mirrors times groups.
std::uint32_t groupCoplanar(std::span<Mirror> mirrors, double tolerance = 1e-3);

/// A curved reflector: it mirrors by an environment map around its centre.
struct CurvedReflector {
    std::uint64_t id = 0;  ///< the caller's; not looked at
    glm::dvec3 centre{0};  ///< world
    double radius = 1;     ///< of a ball that holds it
    MirrorSurface surface;
    bool hasMap = false;  ///< view-independent: a complete map from an earlier frame exists
};

/// Everything there is to reflect and to be reflected. The caller keeps the arrays alive during the call.
struct ReflectionScene {
    std::span<const Mirror> mirrors;
    std::span<const CurvedReflector> curved;
    /// What a view draws besides, world: each node lists those that it may see. May be empty, where the
    /// drawer culls for itself.
    std::span<const city::Aabb> objects;
    /// Boxes that are surely solid: mirrors behind one are left out.
    std::span<const city::Aabb> occluders;
    /// Asked besides, where set: whether what is left of a mirror is hidden from an eye by things that the
    /// caller knows. `glass`: the mirror the eye looks through, relative to the eye; null for an eye before
    /// all mirrors. What lies behind it hides nothing.
    std::function<bool(const EyeView& from, const HalfSpace* glass, const Mirror& mirror)> hidden;
};

}  // namespace reflection
