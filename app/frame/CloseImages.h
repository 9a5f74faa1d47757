#pragma once

#include <glm/mat4x4.hpp>
#include <span>
#include <vector>

#include "city/geometry/Aabb.h"
#include "reflection/chrome/ReflectorMap.h"

namespace app {

/// A box, axes of its own frame, near a piece of chrome.
struct CloseBox {
    city::Aabb box;
    glm::dmat4 partFromBox{1};  ///< rigid

    bool operator==(const CloseBox& b) const {
        return partFromBox == b.partFromBox && box.min == b.box.min && box.max == b.box.max;
    }
};

/// How large a thing is in what a convex piece shows of it, judged by its box.
struct CloseImage {
    bool hidden = false;  ///< all of it stands behind the piece
    double angle = 0;     ///< across, radians seen from the eye; infinite where the box surrounds the piece
    /// Metres that one radian seen from the eye shows of it, at least: there its image is largest.
    double metresPerRadian = 0;
};

/// Convex mirrors never show things larger than a plane one, and what is nearest is shown largest: three
/// short ways from the box's nearest place and from its middle are searched for besides its corners. What a
/// convex piece hides is convex, so a box with hidden corners is hidden. On pieces that are not convex
/// nothing is known: no box is hidden there, and a plane mirror's size is given. `radius`: of a ball around
/// the frame's origin that holds the piece. Boxes that are empty are hidden. Cost: `searchesOfBox` a box.
inline constexpr std::size_t searchesOfBox = 16;
std::vector<CloseImage> closeImages(const reflection::ReflectorMap& map, double radius, const glm::dvec3& eye,
                                    std::span<const CloseBox> boxes);

}  // namespace app
