#pragma once

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "app/frame/View.h"

namespace app {

/// The rays of a view's pixels, for any projection. Pixel coordinates: x to the right, y downwards from the
/// top left corner of the picture, pixels' middles at .5.
class ViewRays {
  public:
    explicit ViewRays(const View& view) : eye(view.eye), exactEye(view.eye) {
        const glm::dmat4 relativeFromClip = glm::inverse(glm::dmat4(view.clipFromView * view.viewFromWorld));
        const auto through = [&](double x, double y) {
            const glm::dvec4 p = relativeFromClip * glm::dvec4(x, y, 1, 1);  // on the near plane
            return glm::dvec3(p) / p.w;
        };
        corner_ = through(-1, 1);
        right_ = (through(1, 1) - corner_) / static_cast<double>(view.size.x);
        down_ = (through(-1, -1) - corner_) / static_cast<double>(view.size.y);
        spread = static_cast<float>(glm::length(right_) / glm::length(corner_ + 0.5 * view.size.x * right_ +
                                                                      0.5 * view.size.y * down_));
    }

    /// From the eye to the near plane.
    glm::vec3 through(const glm::vec2& pixel) const {
        return glm::vec3(corner_ + static_cast<double>(pixel.x) * right_ +
                         static_cast<double>(pixel.y) * down_);
    }

    glm::vec3 eye;
    glm::dvec3 exactEye;
    float spread = 0;  ///< width of a pixel in the picture's middle, for each metre of distance

  private:
    glm::dvec3 corner_{0}, right_{0}, down_{0};
};

}  // namespace app
