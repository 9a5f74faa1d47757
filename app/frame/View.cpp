#include "app/frame/View.h"

#include <cmath>
#include <glm/geometric.hpp>

namespace app {

View lookAt(const glm::dvec3& eye, const glm::dvec3& target, double fovYRadians, glm::ivec2 size,
            double nearPlane) {
    View view;
    view.eye = eye;
    view.size = size;

    const glm::dvec3 towards = target - eye;
    const double length = glm::length(towards);
    if (length > 0 && std::isfinite(length)) {
        const glm::dvec3 forward = towards / length;
        // Straight up or down, north takes the place of up.
        const bool steep = std::abs(forward.z) > 1 - 1e-12;
        const glm::dvec3 right =
            glm::normalize(glm::cross(forward, steep ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, 1)));
        const glm::dvec3 up = glm::cross(right, forward);
        for (int i = 0; i < 3; ++i)
            view.viewFromWorld[i] = glm::vec4(static_cast<float>(right[i]), static_cast<float>(up[i]),
                                              static_cast<float>(-forward[i]), 0);
        view.viewFromWorld[3] = glm::vec4(0, 0, 0, 1);
    }

    // Reversed depth with the far plane at infinity: depth = near / distance along the view axis.
    const double scale = 1 / std::tan(0.5 * fovYRadians);
    const double aspect = size.y > 0 ? static_cast<double>(size.x) / size.y : 1;
    view.clipFromView = glm::mat4(0);
    view.clipFromView[0][0] = static_cast<float>(scale / aspect);
    view.clipFromView[1][1] = static_cast<float>(scale);
    view.clipFromView[2][3] = -1;
    view.clipFromView[3][2] = static_cast<float>(nearPlane);
    return view;
}

}  // namespace app
