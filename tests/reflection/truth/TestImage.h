#pragma once

#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

#include "reflection/truth/ImageError.h"

namespace reflection::test {

struct Image {
    int width;
    int height;
    std::vector<glm::vec3> pixels;

    Image(int w, int h, glm::vec3 colour = glm::vec3(0))
        : width(w), height(h), pixels(static_cast<std::size_t>(w * h), colour) {}
    glm::vec3& at(int x, int y) { return pixels[static_cast<std::size_t>(y * width + x)]; }
    glm::vec3 clamped(int x, int y) const {
        return pixels[static_cast<std::size_t>(std::clamp(y, 0, height - 1) * width +
                                               std::clamp(x, 0, width - 1))];
    }
    ImageView view() const { return {width, height, pixels}; }
};

inline Image noise(int width, int height, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    Image image(width, height);
    for (glm::vec3& p : image.pixels)
        for (int c = 0; c < 3; ++c) p[c] = static_cast<float>(random() >> 40) / static_cast<float>(1 << 24);
    return image;
}

}  // namespace reflection::test
