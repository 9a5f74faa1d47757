#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "city/model/PatternCanvas.h"
#include "city/model/PatternPainters.h"

namespace city {

namespace {

constexpr int groundSize = 256;

}  // namespace

PatternImage paintAsphalt() {
    PatternCanvas canvas(groundSize);
    canvas.fill(glm::vec3(0.93f));
    canvas.grain(4, 3, 0.05f, 51);
    // Chippings: single texels, brighter and darker than the bitumen.
    for (int y = 0; y < groundSize; ++y) {
        for (int x = 0; x < groundSize; ++x) {
            const float chip = latticeValue(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), 52);
            canvas.at(x, y) *= 0.93f + 0.12f * chip * chip;
        }
    }
    return canvas.image();
}

PatternImage paintPavement() {
    PatternCanvas canvas(groundSize);
    canvas.fill(glm::vec3(0.74f));
    constexpr int slabs = 4;
    for (int j = 0; j < slabs; ++j) {
        for (int i = -1; i < slabs; ++i) {
            const float u = (static_cast<float>(i) + (j % 2 == 0 ? 0.0f : 0.5f)) / slabs,
                        v = static_cast<float>(j) / slabs;
            const float tone = 0.9f + 0.09f * latticeValue(static_cast<std::uint32_t>((i + slabs) % slabs),
                                                           static_cast<std::uint32_t>(j), 53);
            canvas.box({u + 0.006f, v + 0.006f}, {u + 1.0f / slabs - 0.006f, v + 1.0f / slabs - 0.006f},
                       glm::vec3(tone, 0.995f * tone, 0.985f * tone));
        }
    }
    canvas.grain(8, 5, 0.045f, 54);
    return canvas.image();
}

PatternImage paintCobbles() {
    PatternCanvas canvas(groundSize);
    canvas.fill(glm::vec3(0.6f));
    constexpr int rows = 16;
    for (int j = 0; j < rows; ++j) {
        for (int i = 0; i < rows; ++i) {
            const auto a = static_cast<std::uint32_t>(i), b = static_cast<std::uint32_t>(j);
            const float tone = 0.84f + 0.16f * latticeValue(a, b, 55);
            const glm::vec2 jitter =
                0.006f * glm::vec2(latticeValue(a, b, 56) - 0.5f, latticeValue(a, b, 57) - 0.5f);
            const glm::vec2 centre = (glm::vec2(static_cast<float>(i) + (j % 2 == 0 ? 0.25f : 0.75f),
                                                static_cast<float>(j) + 0.5f)) /
                                         static_cast<float>(rows) +
                                     jitter;
            canvas.spot(centre, {0.033f, 0.031f}, glm::vec3(0.86f * tone));
            canvas.spot(centre + glm::vec2(-0.002f, 0.003f), {0.026f, 0.024f},
                        glm::vec3(tone, 0.99f * tone, 0.97f * tone));
        }
    }
    canvas.grain(16, 4, 0.05f, 58);
    return canvas.image();
}

PatternImage paintGrass() {
    PatternCanvas canvas(groundSize);
    canvas.fill(glm::vec3(0.93f));
    for (int y = 0; y < groundSize; ++y) {
        for (int x = 0; x < groundSize; ++x) {
            const float u = (static_cast<float>(x) + 0.5f) / groundSize,
                        v = (static_cast<float>(y) + 0.5f) / groundSize;
            const float patch = tileNoise(u, v, 5, 5, 61),
                        blades = tileNoise(u, v, 90, 45, 62) * 0.6f + tileNoise(u, v, 45, 90, 63) * 0.6f;
            const float light = 1 + 0.05f * patch + 0.13f * blades;
            canvas.at(x, y) *= light * glm::vec3(1 + 0.07f * patch, 1, 1 - 0.05f * patch);
        }
    }
    return canvas.image();
}

PatternImage paintSoil() {
    PatternCanvas canvas(groundSize);
    canvas.fill(glm::vec3(0.9f));
    canvas.grain(12, 5, 0.14f, 64);
    return canvas.image();
}

PatternImage paintWater() {
    PatternCanvas canvas(groundSize);
    canvas.fill(glm::vec3(0.93f));
    canvas.grain(6, 4, 0.09f, 65, {1, 2});
    return canvas.image();
}

PatternImage paintRoofTiles() {
    PatternCanvas canvas(groundSize);
    constexpr int rows = 8, columns = 10;
    for (int y = 0; y < groundSize; ++y) {
        for (int x = 0; x < groundSize; ++x) {
            const float v = rows * (static_cast<float>(y) + 0.5f) / groundSize,
                        u = columns * (static_cast<float>(x) + 0.5f) / groundSize;
            const int row = static_cast<int>(v), column = static_cast<int>(u);
            const float s = u - static_cast<float>(column) - 0.5f, t = v - static_cast<float>(row);
            // Pantiles: a wave across, each row casting a shadow on the one below.
            const float wave = 1 - 1.6f * s * s;
            const float lip = t > 0.86f ? 0.62f : 0.9f + 0.1f * t;
            const float tone = 0.88f + 0.14f * latticeValue(static_cast<std::uint32_t>(column),
                                                            static_cast<std::uint32_t>(row), 66);
            canvas.at(x, y) = glm::vec3(std::min(1.0f, (0.72f + 0.3f * wave) * lip * tone));
        }
    }
    canvas.grain(8, 4, 0.05f, 67);
    return canvas.image();
}

PatternImage paintRoofFlat() {
    PatternCanvas canvas(groundSize);
    canvas.fill(glm::vec3(0.92f));
    canvas.grain(5, 6, 0.08f, 68);
    canvas.box({0.3f, 0}, {0.312f, 1}, glm::vec3(0.74f));
    canvas.box({0, 0.3f}, {1, 0.312f}, glm::vec3(0.78f));
    return canvas.image();
}

PatternImage paintMarking() {
    PatternCanvas canvas(groundSize);
    canvas.fill(glm::vec3(0.95f));
    canvas.grain(6, 5, 0.06f, 69);
    return canvas.image();
}

PatternImage paintRail() {
    PatternCanvas canvas(groundSize);
    canvas.fill(glm::vec3(0.9f));
    canvas.grain(24, 3, 0.06f, 70, {1, 0.1f});
    return canvas.image();
}

}  // namespace city
