#include "reflection/local_map/Parallax.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "reflection/reference_maps/CubeMapping.h"

namespace reflection {

namespace {

float nearnessAlong(const LocalMap& map, const glm::vec3& direction) {
    const float greatest = std::max({std::abs(direction.x), std::abs(direction.y), std::abs(direction.z)});
    if (!(greatest > 0) || !std::isfinite(greatest)) return 0;
    const CubePoint point = cubePoint(direction);
    const auto texel = [&](float st) {
        return std::clamp(static_cast<int>((st + 1) * 0.5f * static_cast<float>(map.faceSize)), 0,
                          map.faceSize - 1);
    };
    const float depth =
        map.depth[map.faceOffset(point.face) +
                  static_cast<std::size_t>(texel(point.st.y) * map.faceSize + texel(point.st.x))];
    return depth > 0 ? greatest / depth : 0;
}

}  // namespace

glm::vec3 lookedUpTowards(const LocalMap& map, const glm::vec3& from, const glm::vec3& towards) {
    if (map.faceSize < 1) return towards;
    const float first = nearnessAlong(map, towards);
    const float second = nearnessAlong(map, towards + first * from);
    return towards + first / std::max(2 - second / std::max(first, 1e-6f), 0.25f) * from;
}

}  // namespace reflection
