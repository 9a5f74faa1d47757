#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "app/compare/CompareRow.h"
#include "app/report/Picture.h"
#include "reflection/truth/ImageError.h"

namespace app {

/// The part of a picture in which errors are measured: the mask's bounds and as much around them as the error
/// measures look at. Everything outside is equal in all pictures or does not count.
class ErrorWindow {
  public:
    /// One byte a pixel, 1: counts. `before`: the frame's before, or empty.
    ErrorWindow(std::span<const unsigned char> mask, std::span<const unsigned char> before, glm::ivec2 size);

    bool empty() const { return size_.x <= 0; }
    std::vector<glm::vec3> cut(const Picture& image) const;  ///< display values 0..1
    std::vector<glm::vec3> cut(std::span<const glm::vec3> pixels) const;
    reflection::ImageView view(std::span<const glm::vec3> cut) const { return {size_.x, size_.y, cut}; }
    reflection::PixelMask mask() const { return mask_; }
    /// Pixels that mirror in both frames; empty without a frame before.
    reflection::PixelMask both() const { return both_; }
    bool anyInBoth() const { return anyInBoth_; }

  private:
    glm::ivec2 corner_{0}, size_{0}, whole_{0};
    std::vector<unsigned char> mask_, both_;
    bool anyInBoth_ = false;
};

/// A picture that is judged: looked at once, compared with several.
struct Judged {
    /// `before`: the frame's before, or null. `radiance`: of the whole picture, or empty.
    Judged(const ErrorWindow& window, const Picture& now, const Picture* before,
           std::span<const glm::vec3> radiance);

    std::vector<glm::vec3> now, before, radiance;
    reflection::FlipImage seen;
};

/// What pictures are judged by.
class Judge {
  public:
    /// `structure`: SSIM is measured as well, which takes as long as the rest.
    Judge(const ErrorWindow& window, const Picture& now, const Picture* before,
          std::span<const glm::vec3> radiance, bool structure);

    PictureErrors errorsOf(const Judged& picture) const;

  private:
    const ErrorWindow& window_;
    Judged truth_;
    bool structure_;
};

/// Top left corner of a piece of that size, within a picture of size `whole`, in which most pixels count, or
/// all but a fiftieth of them.
glm::ivec2 richestWindow(std::span<const unsigned char> mask, glm::ivec2 whole, glm::ivec2 size);
Picture cutOut(const Picture& image, glm::ivec2 corner, glm::ivec2 size);
/// FLIP's error as a picture, see errorColour.
Picture differencePicture(const Picture& test, const Picture& reference);

}  // namespace app
