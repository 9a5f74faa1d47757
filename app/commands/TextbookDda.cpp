#include "app/commands/TextbookDda.h"

#include <cmath>
#include <limits>

namespace app {

float textbookDda(const city::Heightfield& field, float highest, const city::Ray& ray) {
    constexpr float infinity = std::numeric_limits<float>::infinity();
    const float cell = field.cellSize();
    const float x = ray.origin.x - static_cast<float>(field.origin().x);
    const float y = ray.origin.y - static_cast<float>(field.origin().y);
    int i = static_cast<int>(x / cell);
    int j = static_cast<int>(y / cell);
    const int width = field.width();
    const int height = field.height();
    if (i < 0 || j < 0 || i >= width || j >= height) return infinity;
    const float* row = field.cells().data();
    const glm::vec3& d = ray.direction;
    const int stepX = d.x > 0 ? 1 : -1;
    const int stepY = d.y > 0 ? 1 : -1;
    const float deltaX = d.x != 0 ? cell / std::abs(d.x) : infinity;
    const float deltaY = d.y != 0 ? cell / std::abs(d.y) : infinity;
    float nextX = d.x != 0 ? (static_cast<float>(d.x > 0 ? i + 1 : i) * cell - x) / d.x : infinity;
    float nextY = d.y != 0 ? (static_cast<float>(d.y > 0 ? j + 1 : j) * cell - y) / d.y : infinity;
    float t = 0;
    for (;;) {
        const float h = row[static_cast<std::ptrdiff_t>(j) * width + i];
        const float zIn = ray.origin.z + t * d.z;
        if (zIn <= h) return t;
        const float tOut = nextX < nextY ? nextX : nextY;
        if (d.z < 0) {
            if (ray.origin.z + tOut * d.z <= h) return (h - ray.origin.z) / d.z;
        } else if (zIn > highest) {
            return infinity;
        }
        t = tOut;
        if (nextX < nextY) {
            i += stepX;
            if (i < 0 || i >= width) return infinity;
            nextX += deltaX;
        } else {
            j += stepY;
            if (j < 0 || j >= height) return infinity;
            nextY += deltaY;
        }
    }
}

}  // namespace app
