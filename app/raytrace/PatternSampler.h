#pragma once

#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include "app/frame/PatternMips.h"

namespace app {

/// How a texture's level of detail follows from how it is seen.
enum class TextureFilter : std::uint8_t {
    standard,  ///< OpenGL's: the longer side of the pixel's footprint, levels blended evenly
    /// Mesa's llvmpipe: the greatest of the four derivatives, levels blended over the upper half of an
    /// octave alone (gallivm's "brilinear").
    llvmpipe,
};

/// Looks up the patterns' texture as shaders do: repeated, linear within and between levels.
class PatternSampler {
  public:
    /// What the shader's sampler would blend: level `lower` and the next, by `share`.
    struct Level {
        int lower = 0;
        float share = 0;
    };

    PatternSampler();

    /// For a footprint whose longest side is `repeats` of the pattern long.
    Level levelOf(float repeats, TextureFilter filter) const;

    /// Root of albedo (rgb) and opacity, 0..1. `pattern` beyond the last takes the last.
    glm::vec4 at(std::uint32_t pattern, const glm::vec2& texcoord, Level level) const;
    float opacityAt(std::uint32_t pattern, const glm::vec2& texcoord, Level level) const;

  private:
    template <int first, int count>
    void lookUp(std::uint32_t pattern, const glm::vec2& texcoord, int level, float weight, float* sum) const;

    PatternMips mips_;
};

}  // namespace app
