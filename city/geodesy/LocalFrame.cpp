#include "city/geodesy/LocalFrame.h"

#include <GeographicLib/LocalCartesian.hpp>
#include <cmath>
#include <stdexcept>

namespace city {

LocalFrame::LocalFrame(double latitude, double longitude, double height)
    : latitude_(latitude), longitude_(longitude), height_(height) {
    if (!std::isfinite(latitude) || !std::isfinite(longitude) || !std::isfinite(height))
        throw std::invalid_argument("a local frame's origin must be finite");
    if (std::abs(latitude) > 90)
        throw std::invalid_argument("a latitude must lie between -90 and 90 degrees");
}

glm::dvec3 LocalFrame::localFromGeodetic(double latitude, double longitude, double height) const {
    const GeographicLib::LocalCartesian frame(latitude_, longitude_, height_);
    glm::dvec3 p;
    frame.Forward(latitude, longitude, height, p.x, p.y, p.z);
    return p;
}

glm::dvec3 LocalFrame::geodeticFromLocal(const glm::dvec3& local) const {
    const GeographicLib::LocalCartesian frame(latitude_, longitude_, height_);
    glm::dvec3 g;
    frame.Reverse(local.x, local.y, local.z, g.x, g.y, g.z);
    return g;
}

}  // namespace city
