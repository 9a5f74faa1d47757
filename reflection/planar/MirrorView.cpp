#include "reflection/planar/MirrorView.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace reflection {

namespace {

bool finite(const glm::dvec3& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

}  // namespace

MirrorView mirrorView(const EyeView& view, const MirrorPlane& mirror) {
    MirrorView result;
    result.view = view;
    if (!finite(view.eye) || !finite(view.viewFromWorld[0]) || !finite(view.viewFromWorld[1]) ||
        !finite(view.viewFromWorld[2]))
        return result;
    result.distance = mirror.signedDistance(view.eye);
    if (std::abs(result.distance) <= mirror.sideTolerance(view.eye)) {
        result.status = MirrorViewStatus::eyeInPlane;
        return result;
    }
    result.status = result.distance > 0 ? MirrorViewStatus::ok : MirrorViewStatus::eyeBehind;
    result.view.eye = view.eye - 2 * result.distance * mirror.normal();
    result.view.viewFromWorld = view.viewFromWorld * mirror.reflection();
    return result;
}

ObliqueNear obliqueNear(const EyeView& view, const MirrorPlane& mirror, const NdcRect& rect) {
    ObliqueNear result;
    result.clipFromView = view.clipFromView;
    const double behind = -mirror.signedDistance(view.eye);
    if (!(behind > mirror.sideTolerance(view.eye))) return result;
    const glm::dvec3 n = view.viewFromWorld * mirror.normal();  // points away from the eye's side
    const glm::dmat4& c = view.clipFromView;
    // The plane's distance grows along a view ray of unit depth by n . ray: linear over the image.
    double growth = 0;
    for (const glm::dvec2& ndc :
         {rect.low, rect.high, glm::dvec2(rect.low.x, rect.high.y), glm::dvec2(rect.high.x, rect.low.y)}) {
        // x = c00 vx + c20 vz with w = -vz = 1
        const glm::dvec3 ray((ndc.x + c[2][0]) / c[0][0], (ndc.y + c[2][1]) / c[1][1], -1);
        growth = std::max(growth, glm::dot(n, ray));
    }
    if (!(growth > 0) || !std::isfinite(growth)) {
        result.status = ObliqueStatus::nothingInFront;
        return result;
    }
    result.status = ObliqueStatus::ok;
    result.scale = growth;
    const glm::dvec4 plane(n, -behind);
    for (int i = 0; i < 4; ++i) result.clipFromView[i][2] = c[i][3] - plane[i] / growth;
    return result;
}

double depthStep(const glm::dmat4& clipFromRelative, const glm::dvec3& relative) {
    const double distance = glm::length(relative);
    if (!(distance > 0)) return std::numeric_limits<double>::infinity();
    const glm::dvec4 at = clipFromRelative * glm::dvec4(relative, 1);
    const glm::dvec4 along = clipFromRelative * glm::dvec4(relative / distance, 0);
    // d(z/w)/dt along the ray
    const double slope = std::abs(along.z * at.w - at.z * along.w) / (at.w * at.w);
    const auto depth = static_cast<float>(at.z / at.w);
    const double step = static_cast<double>(std::nextafter(depth, 2.f)) - static_cast<double>(depth);
    return slope > 0 ? step / slope : std::numeric_limits<double>::infinity();
}

}  // namespace reflection
