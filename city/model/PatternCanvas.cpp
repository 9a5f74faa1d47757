#include "city/model/PatternCanvas.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

namespace city {

namespace {

std::uint32_t mixed(std::uint32_t x) {
    // Finaliser of MurmurHash3 (Appleby).
    x ^= x >> 16;
    x *= 0x85ebca6bu;
    x ^= x >> 13;
    x *= 0xc2b2ae35u;
    return x ^ (x >> 16);
}

float smooth(float t) {
    return t * t * (3 - 2 * t);
}

}  // namespace

float latticeValue(std::uint32_t x, std::uint32_t y, std::uint32_t seed) {
    return static_cast<float>(mixed(x * 0x9e3779b1u + mixed(y * 0x85ebca77u + seed)) >> 8) * 0x1p-24f;
}

float tileNoise(float u, float v, int cellsU, int cellsV, std::uint32_t seed) {
    const float x = (u - std::floor(u)) * static_cast<float>(cellsU),
                y = (v - std::floor(v)) * static_cast<float>(cellsV);
    const int i = static_cast<int>(x), j = static_cast<int>(y);
    const float s = smooth(x - static_cast<float>(i)), t = smooth(y - static_cast<float>(j));
    const auto value = [&](int a, int b) {
        return latticeValue(static_cast<std::uint32_t>(a % cellsU), static_cast<std::uint32_t>(b % cellsV),
                            seed);
    };
    const float low = value(i, j) * (1 - s) + value(i + 1, j) * s;
    const float high = value(i, j + 1) * (1 - s) + value(i + 1, j + 1) * s;
    return 2 * (low * (1 - t) + high * t) - 1;
}

PatternCanvas::PatternCanvas(int size)
    : size_(size),
      texels_(static_cast<std::size_t>(size) * static_cast<std::size_t>(size), glm::vec3(1)),
      alpha_(texels_.size(), 1.0f) {}

void PatternCanvas::fill(const glm::vec3& colour) {
    std::fill(texels_.begin(), texels_.end(), colour);
}

void PatternCanvas::box(glm::vec2 low, glm::vec2 high, const glm::vec3& bottom, const glm::vec3& top) {
    const auto n = static_cast<float>(size_);
    const glm::vec2 a = low * n, b = high * n;
    const auto overlap = [](float cell, float from, float to) {
        return std::max(0.0f, std::min(cell + 1, to) - std::max(cell, from));
    };
    for (int y = std::max(0, static_cast<int>(a.y)); y < std::min(size_, static_cast<int>(b.y) + 1); ++y) {
        const float t =
            std::clamp((static_cast<float>(y) + 0.5f - a.y) / std::max(b.y - a.y, 1e-3f), 0.0f, 1.0f);
        const glm::vec3 colour = bottom + t * (top - bottom);
        const float rows = overlap(static_cast<float>(y), a.y, b.y);
        for (int x = std::max(0, static_cast<int>(a.x)); x < std::min(size_, static_cast<int>(b.x) + 1);
             ++x) {
            const float cover = rows * overlap(static_cast<float>(x), a.x, b.x);
            at(x, y) += cover * (colour - at(x, y));
        }
    }
}

void PatternCanvas::spot(glm::vec2 centre, glm::vec2 radius, const glm::vec3& colour, float opacity) {
    const auto n = static_cast<float>(size_);
    const int x0 = static_cast<int>(std::floor((centre.x - radius.x) * n)) - 1,
              x1 = static_cast<int>(std::ceil((centre.x + radius.x) * n)) + 1;
    const int y0 = static_cast<int>(std::floor((centre.y - radius.y) * n)) - 1,
              y1 = static_cast<int>(std::ceil((centre.y + radius.y) * n)) + 1;
    const float edge = 1 / (n * std::min(radius.x, radius.y));
    for (int y = y0; y <= y1; ++y) {
        for (int x = x0; x <= x1; ++x) {
            const glm::vec2 d =
                (glm::vec2(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f) / n - centre) / radius;
            const float cover =
                opacity * std::clamp((1 - std::sqrt(d.x * d.x + d.y * d.y)) / edge + 0.5f, 0.0f, 1.0f);
            if (cover <= 0) continue;
            glm::vec3& texel = at(((x % size_) + size_) % size_, ((y % size_) + size_) % size_);
            texel += cover * (colour - texel);
        }
    }
}

void PatternCanvas::shade(glm::vec2 low, glm::vec2 high, float factorBottom, float factorTop) {
    const auto n = static_cast<float>(size_);
    for (int y = static_cast<int>(low.y * n); y < std::min(size_, static_cast<int>(high.y * n)); ++y) {
        const float t = std::clamp(
            (static_cast<float>(y) + 0.5f - low.y * n) / std::max((high.y - low.y) * n, 1e-3f), 0.0f, 1.0f);
        for (int x = static_cast<int>(low.x * n); x < std::min(size_, static_cast<int>(high.x * n)); ++x) {
            at(x, y) *= factorBottom + t * (factorTop - factorBottom);
        }
    }
}

void PatternCanvas::grain(int cells, int octaves, float amplitude, std::uint32_t seed, glm::vec2 stretch) {
    for (int y = 0; y < size_; ++y) {
        for (int x = 0; x < size_; ++x) {
            const float u = (static_cast<float>(x) + 0.5f) / static_cast<float>(size_),
                        v = (static_cast<float>(y) + 0.5f) / static_cast<float>(size_);
            float sum = 0, weight = 1, total = 0;
            for (int k = 0; k < octaves; ++k) {
                const int cu = std::max(1, static_cast<int>(static_cast<float>(cells << k) * stretch.x));
                const int cv = std::max(1, static_cast<int>(static_cast<float>(cells << k) * stretch.y));
                sum += weight * tileNoise(u, v, cu, cv, seed + static_cast<std::uint32_t>(k));
                total += weight;
                weight *= 0.7f;
            }
            at(x, y) *= 1 + amplitude * sum / total;
        }
    }
}

void PatternCanvas::grain(glm::vec2 low, glm::vec2 high, int cells, int octaves, float amplitude,
                          std::uint32_t seed) {
    PatternCanvas whole(size_);
    whole.grain(cells, octaves, amplitude, seed);
    const auto n = static_cast<float>(size_);
    for (int y = static_cast<int>(low.y * n); y < std::min(size_, static_cast<int>(high.y * n)); ++y)
        for (int x = static_cast<int>(low.x * n); x < std::min(size_, static_cast<int>(high.x * n)); ++x)
            at(x, y) *= whole.at(x, y);
}

PatternImage PatternCanvas::image() const {
    PatternImage image;
    image.size = size_;
    image.rgba.reserve(texels_.size() * 4);
    const auto byte = [](float v) {
        return static_cast<std::uint8_t>(std::lround(std::clamp(v, 0.0f, 1.0f) * 255));
    };
    for (std::size_t i = 0; i < texels_.size(); ++i) {
        const glm::vec3& c = texels_[i];
        image.rgba.insert(image.rgba.end(), {byte(c.x), byte(c.y), byte(c.z), byte(alpha_[i])});
    }
    return image;
}

}  // namespace city
