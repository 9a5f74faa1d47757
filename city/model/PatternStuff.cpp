#include <algorithm>
#include <cmath>

#include "city/model/PatternCanvas.h"
#include "city/model/PatternPainters.h"

namespace city {

PatternImage paintPlain() {
    return PatternCanvas(256).image();
}

PatternImage paintWall() {
    PatternCanvas canvas(256);
    canvas.fill(glm::vec3(0.955f));
    canvas.grain(5, 6, 0.05f, 81);
    // Streaks of rain.
    canvas.grain(20, 2, 0.02f, 82, {1, 0.1f});
    return canvas.image();
}

PatternImage paintBark() {
    PatternCanvas canvas(256);
    canvas.fill(glm::vec3(0.9f));
    canvas.grain(14, 4, 0.22f, 83, {1, 0.2f});
    canvas.grain(8, 3, 0.06f, 84);
    return canvas.image();
}

PatternImage paintFoliage() {
    constexpr int size = 256;
    PatternCanvas canvas(size);
    canvas.fill(glm::vec3(0.93f));
    canvas.grain(5, 4, 0.08f, 85);
    // A paler rib up the middle and veins from it; opaque where the leaf is, open outside, for those who cut
    // out.
    for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
            const float u = (static_cast<float>(x) + 0.5f) / size - 0.5f,
                        v = (static_cast<float>(y) + 0.5f) / size;
            const float vein = 9 * (v - 0.7f * std::abs(u));
            const float inVein = std::abs(vein - std::floor(vein) - 0.5f);
            float light = inVein < 0.06f ? 1.07f : 1.0f;
            if (std::abs(u) < 0.015f) light = 1.12f;
            canvas.at(x, y) *= light * glm::vec3(1, 1, 0.96f);
            // An oval whose widest place lies below the middle.
            const float half = 1.35f * std::sqrt(std::max(0.0f, v)) * (1 - v) * 0.85f;
            canvas.alpha(x, y) = std::abs(u) < half ? 1.0f : 0.0f;
        }
    }
    return canvas.image();
}

PatternImage paintMetal() {
    PatternCanvas canvas(256);
    canvas.fill(glm::vec3(0.95f));
    canvas.grain(4, 4, 0.04f, 86);
    // Standing seams, two a repeat.
    for (const float u : {0.0f, 0.5f}) {
        canvas.box({u, 0}, {u + 0.012f, 1}, glm::vec3(0.8f));
        canvas.box({u + 0.012f, 0}, {u + 0.024f, 1}, glm::vec3(1.0f));
    }
    return canvas.image();
}

}  // namespace city
