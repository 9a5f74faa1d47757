#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "city/model/PatternImages.h"

namespace city {

/// Something to paint a tileable picture on: sRGB-encoded colours in 0..1, coordinates in repeats (0..1, v
/// upwards), everything wraps at the borders. Sums and products of floats only, so that every machine paints
/// the same bytes.
class PatternCanvas {
  public:
    explicit PatternCanvas(int size);

    int size() const { return size_; }
    void fill(const glm::vec3& colour);
    /// Covers u0..u1, v0..v1 with colour from bottom to top; edges are antialiased.
    void box(glm::vec2 low, glm::vec2 high, const glm::vec3& bottom, const glm::vec3& top);
    void box(glm::vec2 low, glm::vec2 high, const glm::vec3& colour) { box(low, high, colour, colour); }
    /// Ellipse, antialiased.
    void spot(glm::vec2 centre, glm::vec2 radius, const glm::vec3& colour, float opacity = 1);
    /// Darkens (or lightens) by a factor that falls to 1 over `reach` below the given edge: a soft shadow.
    void shade(glm::vec2 low, glm::vec2 high, float factorBottom, float factorTop);
    /// Multiplies by 1 + amplitude * noise of `cells` lumps a repeat, with `octaves` finer layers; noise in
    /// -1..1.
    void grain(int cells, int octaves, float amplitude, std::uint32_t seed, glm::vec2 stretch = {1, 1});
    /// The same, restricted to a box.
    void grain(glm::vec2 low, glm::vec2 high, int cells, int octaves, float amplitude, std::uint32_t seed);

    glm::vec3& at(int x, int y) {
        return texels_[static_cast<std::size_t>(y) * static_cast<std::size_t>(size_) +
                       static_cast<std::size_t>(x)];
    }
    float& alpha(int x, int y) {
        return alpha_[static_cast<std::size_t>(y) * static_cast<std::size_t>(size_) +
                      static_cast<std::size_t>(x)];
    }
    PatternImage image() const;

  private:
    int size_;
    std::vector<glm::vec3> texels_;
    std::vector<float> alpha_;
};

/// Value in 0..1 from two whole numbers and a seed.
float latticeValue(std::uint32_t x, std::uint32_t y, std::uint32_t seed);
/// Smooth tileable noise in -1..1 at (u, v) in repeats with whole numbers of cells a repeat.
float tileNoise(float u, float v, int cellsU, int cellsV, std::uint32_t seed);

}  // namespace city
