#pragma once

#include <glm/vec3.hpp>

namespace city {

/// Local east-north-up frame that touches the WGS84 ellipsoid at an origin (GeographicLib::LocalCartesian).
class LocalFrame {
  public:
    /// Latitude and longitude in degrees, height in metres above the ellipsoid. Throws std::invalid_argument
    /// unless all are finite and |latitude| <= 90.
    LocalFrame(double latitude, double longitude, double height);

    glm::dvec3 localFromGeodetic(double latitude, double longitude, double height) const;  ///< metres
    glm::dvec3 geodeticFromLocal(
        const glm::dvec3& local) const;  ///< latitude, longitude (degrees), height (metres)

    double latitude() const { return latitude_; }
    double longitude() const { return longitude_; }
    double height() const { return height_; }

  private:
    double latitude_;
    double longitude_;
    double height_;
};

}  // namespace city
