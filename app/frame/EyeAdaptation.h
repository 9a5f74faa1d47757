#pragma once

#include <glm/vec3.hpp>
#include <optional>

#include "app/frame/Lighting.h"
#include "reflection/tracing/GridTracer.h"

namespace app {

/// How many times longer than in the open a camera at `eye` (world metres) exposes: 1 where most of what
/// stands around it is in the sun, up to `longestExposure` in a shaded street. From what the heightfield
/// around the eye lets through of sun and sky, in all directions of the horizon: the same for every display
/// around one viewer, wherever they look, and for every way to reflect. Relative to the light of the hour,
/// whose own exposure answers dusk and night. 1 for an eye or a light that is not finite. Cost: about 200
/// rays.
double exposureAround(const reflection::GridTracer& tracer, const Lighting& lighting, const glm::dvec3& eye);

inline constexpr double longestExposure = 2.5;  ///< 1.3 stops: a shaded street still looks shaded

/// Follows those exposures as an eye does: slowly while it moves, at once where a film cuts to another place.
class EyeAdaptation {
  public:
    /// The exposure shown now; `seconds` since the last call (negative and NaN count as 0). It rests once
    /// what is left to go is less than a step of a display, so that a view that stands need not be drawn
    /// again.
    double follow(double wanted, const glm::dvec3& eye, double seconds);

  private:
    struct Seen {
        glm::dvec3 eye;
        double exposure;
    };
    std::optional<Seen> last_;
};

}  // namespace app
