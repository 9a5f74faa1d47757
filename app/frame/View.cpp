#include "app/frame/View.h"

#include "reflection/planar/EyeView.h"

namespace app {

View lookAt(const glm::dvec3& eye, const glm::dvec3& target, double fovYRadians, glm::ivec2 size,
            double nearPlane) {
    const double aspect = size.y > 0 ? static_cast<double>(size.x) / size.y : 1;
    const reflection::EyeView exact =
        reflection::perspectiveView(eye, target, fovYRadians, aspect, nearPlane);
    View view;
    view.eye = eye;
    view.size = size;
    view.viewFromWorld = glm::mat4(glm::mat3(exact.viewFromWorld));
    view.clipFromView = glm::mat4(exact.clipFromView);
    return view;
}

}  // namespace app
