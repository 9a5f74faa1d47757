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
    explicit ViewRays(const View& view) : eye(view.eye) {
        const glm::dmat4 relativeFromClip = glm::inverse(glm::dmat4(view.clipFromView * view.viewFromWorld));
        const auto through = [&](double x, double y) {
            const glm::dvec4 p = relativeFromClip * glm::dvec4(x, y, 1, 1);  // on the near plane
            return glm::dvec3(p) / p.w;
        };
        const glm::dvec3 corner = through(-1, 1);
        corner_ = glm::vec3(corner);
        right_ = glm::vec3((through(1, 1) - corner) / static_cast<double>(view.size.x));
        down_ = glm::vec3((through(-1, -1) - corner) / static_cast<double>(view.size.y));
        spread = glm::length(right_) / glm::length(glm::vec3(through(0, 0)));
    }

    /// From the eye to the near plane. In floats: off by a ten thousandth of a pixel in pictures of a few
    /// thousand.
    glm::vec3 through(const glm::vec2& pixel) const { return corner_ + pixel.x * right_ + pixel.y * down_; }

    glm::vec3 eye;
    float spread = 0;  ///< width of a pixel in the picture's middle, for each metre of distance

  private:
    glm::vec3 corner_{0}, right_{0}, down_{0};
};

}  // namespace app
