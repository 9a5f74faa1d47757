#include "reflection/planar/EyeView.h"

#include <cmath>
#include <cstddef>

#include "reflection/reference_maps/CubeMapping.h"

namespace reflection {

namespace {

/// Rows: right, up, backwards.
glm::dmat3 viewAxes(const glm::dvec3& right, const glm::dvec3& up, const glm::dvec3& forward) {
    return glm::transpose(glm::dmat3(right, up, -forward));
}

glm::dmat4 reversedPerspective(double scaleX, double scaleY, double nearPlane) {
    glm::dmat4 clip(0);
    clip[0][0] = scaleX;
    clip[1][1] = scaleY;
    clip[2][3] = -1;
    clip[3][2] = nearPlane;
    return clip;
}

/// Rotation that looks along `towards`, up as far as may be; the identity without a direction.
glm::dmat3 uprightAxes(const glm::dvec3& towards) {
    const double length = glm::length(towards);
    if (!(length > 0) || !std::isfinite(length)) return glm::dmat3(1);
    const glm::dvec3 forward = towards / length;
    // Straight up or down, north takes the place of up.
    const bool steep = std::abs(forward.z) > 1 - 1e-12;
    const glm::dvec3 right =
        glm::normalize(glm::cross(forward, steep ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, 1)));
    return viewAxes(right, glm::cross(right, forward), forward);
}

}  // namespace

EyeView perspectiveView(const glm::dvec3& eye, const glm::dvec3& target, double fovYRadians, double aspect,
                        double nearPlane) {
    EyeView view;
    view.eye = eye;
    view.viewFromWorld = uprightAxes(target - eye);
    const double scale = 1 / std::tan(0.5 * fovYRadians);
    view.clipFromView = reversedPerspective(scale / aspect, scale, nearPlane);
    return view;
}

EyeView cubeFaceView(const glm::dvec3& eye, int face, double nearPlane) {
    const CubeFace& f = cubeFaces[static_cast<std::size_t>(face)];
    EyeView view;
    view.eye = eye;
    view.viewFromWorld = viewAxes(glm::dvec3(f.sAxis), glm::dvec3(f.tAxis), glm::dvec3(f.major));
    view.clipFromView = reversedPerspective(1, 1, nearPlane);
    return view;
}

EyeView paraboloidView(const glm::dvec3& eye, int half, double nearPlane) {
    EyeView view;
    view.eye = eye;
    view.viewFromWorld =
        half == 0 ? viewAxes({1, 0, 0}, {0, -1, 0}, {0, 0, 1}) : viewAxes({1, 0, 0}, {0, 1, 0}, {0, 0, -1});
    view.clipFromView = reversedPerspective(1, 1, nearPlane);
    view.projection = Projection::paraboloid;
    return view;
}

glm::dmat4 cropped(const glm::dmat4& clipFromView, const NdcRect& rect) {
    const glm::dvec2 middle = 0.5 * (rect.low + rect.high), half = 0.5 * rect.size();
    glm::dmat4 crop(1);
    crop[0][0] = 1 / half.x;
    crop[1][1] = 1 / half.y;
    // x' = (x - middle w) / half
    crop[3] = glm::dvec4(-middle.x / half.x, -middle.y / half.y, 0, 1);
    return crop * clipFromView;
}

}  // namespace reflection
