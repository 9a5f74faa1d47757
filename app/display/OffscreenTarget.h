#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace app {

/// A framebuffer of 8 bit RGBA pixels to draw a view into. Needs the same OpenGL context current from
/// construction to destruction. Throws std::runtime_error when the driver cannot make one of that size.
class OffscreenTarget {
  public:
    explicit OffscreenTarget(glm::ivec2 size);
    ~OffscreenTarget();
    OffscreenTarget(const OffscreenTarget&) = delete;
    OffscreenTarget& operator=(const OffscreenTarget&) = delete;

    std::uint32_t framebuffer() const;  ///< GL name
    glm::ivec2 size() const { return size_; }
    /// Copies the pixels into another framebuffer, stretched to its size.
    void copyTo(std::uint32_t framebuffer, glm::ivec2 size) const;

  private:
    glm::ivec2 size_;
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Returns when OpenGL has done everything asked of it, so that a clock read next tells the truth.
void finishDrawing();

/// Name and value of the limits of the current context that matter here.
std::vector<std::pair<std::string, std::string>> contextLimits();

}  // namespace app
