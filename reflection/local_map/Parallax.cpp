#include "reflection/local_map/Parallax.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "reflection/reference_maps/CubeMapping.h"

namespace reflection {

namespace {

float greatestOf(const glm::vec3& v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

float nearnessAlong(const LocalMap& map, const glm::vec3& direction) {
    const float depth = depthTowards(map, direction);
    return depth > 0 ? greatestOf(direction) / depth : 0;
}

}  // namespace

float depthTowards(const LocalMap& map, const glm::vec3& direction) {
    const float greatest = greatestOf(direction);
    if (map.faceSize < 1 || !(greatest > 0) || !std::isfinite(greatest))
        return std::numeric_limits<float>::quiet_NaN();
    const CubePoint point = cubePoint(direction);
    const auto texel = [&](float st) {
        return std::clamp(static_cast<int>((st + 1) * 0.5f * static_cast<float>(map.faceSize)), 0,
                          map.faceSize - 1);
    };
    return map.depth[map.faceOffset(point.face) +
                     static_cast<std::size_t>(texel(point.st.y) * map.faceSize + texel(point.st.x))];
}

glm::vec3 lookedUpTowards(const LocalMap& map, const glm::vec3& from, const glm::vec3& towards) {
    const float first = nearnessAlong(map, towards);
    const float second = nearnessAlong(map, towards + first * from);
    return towards + first / std::max(2 - second / std::max(first, 1e-6f), 0.25f) * from;
}

}  // namespace reflection
