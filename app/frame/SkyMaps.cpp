#include "app/frame/SkyMaps.h"

#include <tbb/parallel_for.h>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <limits>

#include "app/frame/Sky.h"
#include "reflection/reference_maps/CubeMapping.h"

namespace app {

namespace {

/// Mean of a texel's quarters: the sun's disc is smaller than a texel.
glm::vec3 texelOf(const Lighting& lighting, int face, int x, int y, int n) {
    glm::vec3 sum(0);
    for (int k = 0; k < 4; ++k) {
        const glm::vec2 at = glm::vec2(x, y) + glm::vec2(0.25f + 0.5f * static_cast<float>(k & 1),
                                                         0.25f + 0.5f * static_cast<float>(k >> 1));
        sum += skyRadiance(lighting, glm::normalize(reflection::cubeDirection(face, at, n)));
    }
    return 0.25f * sum;
}

}  // namespace

const reflection::LocalMap& SkyMaps::of(const Lighting& lighting, int faceSize) {
    if (!(lighting == lighting_)) {
        maps_.clear();
        lighting_ = lighting;
    }
    const auto [place, isNew] = maps_.try_emplace(faceSize);
    reflection::LocalMap& map = place->second;
    if (!isNew) return map;
    map.resize(faceSize);
    tbb::parallel_for(0, 6 * faceSize, [&](int row) {
        const int face = row / faceSize, y = row % faceSize;
        for (int x = 0; x < faceSize; ++x) {
            const std::size_t i = map.faceOffset(face) +
                                  static_cast<std::size_t>(y) * static_cast<std::size_t>(faceSize) +
                                  static_cast<std::size_t>(x);
            const glm::vec3 colour = texelOf(lighting, face, x, y, faceSize);
            map.red[i] = colour.r;
            map.green[i] = colour.g;
            map.blue[i] = colour.b;
            map.depth[i] = std::numeric_limits<float>::infinity();
        }
    });
    return map;
}

}  // namespace app
