#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "app/raytrace/RayPaths.h"
#include "app/raytrace/RayTracer.h"
#include "app/raytrace/ViewRays.h"

namespace app {

/// A pixel whose middle shows a vehicle.
struct MirrorPixel {
    glm::ivec2 pixel{0};  ///< column, row from the top
    const PlacedMesh* placed = nullptr;
    MetTriangle triangle;
    glm::vec2 weights{0};
};

/// Finds the light that pixels mirror: the mean over the pixel's area, on the plane of the triangle that its
/// middle shows (as a rasteriser takes derivatives), so that outlines stay those of one sample a pixel. Keep
/// one for each thread.
class MirrorPixels {
  public:
    /// `light` as long as `pixels`. Returns the number of rays.
    std::uint64_t gather(const RayPaths::Scene& scene, const ViewRays& view,
                         std::span<const MirrorPixel> pixels, const TraceOptions& options,
                         std::span<glm::vec3> light);

  private:
    void addPixel(const RayPaths::Scene& scene, const ViewRays& view, const MirrorPixel& pixel,
                  const TraceOptions& options, std::uint32_t sum);

    RayPaths paths_;
};

}  // namespace app
