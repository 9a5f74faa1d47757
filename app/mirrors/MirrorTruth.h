#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <vector>

#include "app/mirrors/MirrorWorld.h"

namespace app {

struct MirrorTruthOptions {
    int depth = 2;  ///< mirrors in a row; what the next one mirrors is MirrorWorld::beyond
    std::uint32_t samples =
        64;  ///< paths a pixel where a rough mirror is met, all through the pixel's middle
    std::uint64_t seed = 1;
};

/// A ray traced picture, row 0 at the top.
struct TracedPicture {
    glm::ivec2 size{0};
    std::vector<glm::vec3> radiance;
    /// Mirrors in a row that the pixel's middle shows, were they smooth; at most the depth asked for.
    std::vector<std::uint8_t> level;
    std::vector<std::uint8_t> curved;  ///< 1 where one of them is curved
};

/// A MirrorWorld as rays see it (Embree): exact reflections in flat mirrors; in curved ones (their
/// finest triangles) at the interpolated normal, as the rasteriser shades them, but from the very point.
/// Rough mirrors: normals of microfacets with Gaussian slopes of variance roughness^4 / 2 on each axis, in
/// the proportion in which they are visible, without shadowing; every mirror on the way is rough at every
/// sample.
class MirrorTruth {
  public:
    explicit MirrorTruth(const MirrorWorld& world);  ///< keeps a reference; throws where Embree cannot start
    ~MirrorTruth();

    TracedPicture picture(const reflection::TreeView& view, const MirrorTruthOptions& options) const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace app
