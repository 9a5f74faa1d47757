#include "app/frame/SunMap.h"

#include <algorithm>
#include <cmath>

namespace app {

float SunMap::lightAt(const glm::vec3& coordinate) const {
    if (size <= 0) return 1;
    const float x = coordinate.x * static_cast<float>(size) - 0.5f;
    const float y = coordinate.y * static_cast<float>(size) - 0.5f;
    // The border's depth is 0, which every depth in 0..1 passes.
    if (!(x > -1 && y > -1 && x < static_cast<float>(size) && y < static_cast<float>(size))) return 1;
    const int i = static_cast<int>(std::floor(x)), j = static_cast<int>(std::floor(y));
    const float fx = x - static_cast<float>(i), fy = y - static_cast<float>(j);
    // A depth reference is clamped and compared as a float with what 16 bits hold.
    const float reference = std::clamp(coordinate.z, 0.0f, 1.0f);
    const auto lit = [&](int tx, int ty) {
        if (tx < 0 || ty < 0 || tx >= size || ty >= size) return 1.0f;
        const std::uint16_t d = depth[static_cast<std::size_t>(ty) * static_cast<std::size_t>(size) +
                                      static_cast<std::size_t>(tx)];
        return reference >= static_cast<float>(d) * (1.0f / 65535.0f) ? 1.0f : 0.0f;
    };
    const float low = lit(i, j) * (1 - fx) + lit(i + 1, j) * fx;
    const float high = lit(i, j + 1) * (1 - fx) + lit(i + 1, j + 1) * fx;
    return low * (1 - fy) + high * fy;
}

}  // namespace app
