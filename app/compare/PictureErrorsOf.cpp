#include "app/compare/PictureErrorsOf.h"

#include <algorithm>
#include <glm/common.hpp>

#include "app/compare/PictureStrip.h"

namespace app {

namespace {

/// Pixels around the mask: FLIP's widest filter has a radius of 10 at its default distance, features 9 on
/// top of nothing; 24 covers both one behind the other.
constexpr int margin = 24;

std::size_t at(int x, int y, int width) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
}

glm::vec3 pixelOf(std::span<const std::uint8_t> rgba, std::size_t i) {
    return glm::vec3(rgba[4 * i], rgba[4 * i + 1], rgba[4 * i + 2]) / 255.0f;
}

std::vector<glm::vec3> pixelsOf(const Picture& picture) {
    std::vector<glm::vec3> pixels(picture.rgba.size() / 4);
    for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = pixelOf(picture.rgba, i);
    return pixels;
}

}  // namespace

ErrorWindow::ErrorWindow(std::span<const unsigned char> mask, std::span<const unsigned char> before,
                         glm::ivec2 size)
    : whole_(size) {
    glm::ivec2 low = size, high(-1);
    for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x)
            if (mask[at(x, y, size.x)] != 0) {
                low = glm::min(low, glm::ivec2(x, y));
                high = glm::max(high, glm::ivec2(x, y));
            }
    if (high.x < 0) return;
    corner_ = glm::max(low - margin, glm::ivec2(0));
    size_ = glm::min(high + margin + 1, size) - corner_;
    for (int y = 0; y < size_.y; ++y)
        for (int x = 0; x < size_.x; ++x) {
            const std::size_t i = at(corner_.x + x, corner_.y + y, size.x);
            mask_.push_back(mask[i]);
            if (before.empty()) continue;
            both_.push_back(mask[i] != 0 && before[i] != 0 ? 1 : 0);
            anyInBoth_ = anyInBoth_ || both_.back() != 0;
        }
}

std::vector<glm::vec3> ErrorWindow::cut(const Picture& image) const {
    std::vector<glm::vec3> pixels;
    pixels.reserve(mask_.size());
    for (int y = 0; y < size_.y; ++y)
        for (int x = 0; x < size_.x; ++x)
            pixels.push_back(pixelOf(image.rgba, at(corner_.x + x, corner_.y + y, whole_.x)));
    return pixels;
}

std::vector<glm::vec3> ErrorWindow::cut(std::span<const glm::vec3> pixels) const {
    std::vector<glm::vec3> cut;
    cut.reserve(mask_.size());
    for (int y = 0; y < size_.y; ++y)
        for (int x = 0; x < size_.x; ++x) cut.push_back(pixels[at(corner_.x + x, corner_.y + y, whole_.x)]);
    return cut;
}

Judged::Judged(const ErrorWindow& window, const Picture& nowImage, const Picture* beforeImage,
               std::span<const glm::vec3> wholeRadiance)
    : now(window.cut(nowImage)), seen(window.view(now)) {
    if (beforeImage != nullptr && !beforeImage->rgba.empty()) before = window.cut(*beforeImage);
    if (!wholeRadiance.empty()) radiance = window.cut(wholeRadiance);
}

Judge::Judge(const ErrorWindow& window, const Picture& now, const Picture* before,
             std::span<const glm::vec3> radiance, bool structure)
    : window_(window), truth_(window, now, before, radiance), structure_(structure) {}

PictureErrors Judge::errorsOf(const Judged& picture) const {
    PictureErrors errors;
    const reflection::ImageView test = window_.view(picture.now), truth = window_.view(truth_.now);
    errors.psnr = reflection::psnr(test, truth, window_.mask());
    errors.flip = reflection::meanError(reflection::flip(picture.seen, truth_.seen), window_.mask());
    if (structure_) errors.ssim = reflection::ssim(test, truth, window_.mask());
    if (!picture.radiance.empty() && !truth_.radiance.empty())
        errors.hdrFlip = reflection::meanError(
            reflection::hdrFlip(window_.view(picture.radiance), window_.view(truth_.radiance)),
            window_.mask());
    if (window_.anyInBoth() && !picture.before.empty() && !truth_.before.empty())
        errors.flicker = reflection::flicker(test, window_.view(picture.before), truth,
                                             window_.view(truth_.before), window_.both());
    return errors;
}

glm::ivec2 richestWindow(std::span<const unsigned char> mask, glm::ivec2 whole, glm::ivec2 size) {
    // Sums over rectangles from the corner make each window four look-ups.
    const int width = whole.x + 1;
    std::vector<std::uint32_t> sums(static_cast<std::size_t>(width) * static_cast<std::size_t>(whole.y + 1));
    for (int y = 0; y < whole.y; ++y)
        for (int x = 0; x < whole.x; ++x)
            sums[at(x + 1, y + 1, width)] = (mask[at(x, y, whole.x)] != 0 ? 1u : 0u) +
                                            sums[at(x, y + 1, width)] + sums[at(x + 1, y, width)] -
                                            sums[at(x, y, width)];
    const auto countAt = [&](int x, int y) {
        return sums[at(x + size.x, y + size.y, width)] + sums[at(x, y, width)] -
               sums[at(x, y + size.y, width)] - sums[at(x + size.x, y, width)];
    };
    std::uint32_t most = 0;
    for (int y = 0; y + size.y <= whole.y; ++y)
        for (int x = 0; x + size.x <= whole.x; ++x) most = std::max(most, countAt(x, y));
    // Of those that hold nearly as much the middle one: what is looked at is not at the picture's edge.
    glm::dvec2 sum(0);
    double count = 0;
    for (int y = 0; y + size.y <= whole.y; ++y)
        for (int x = 0; x + size.x <= whole.x; ++x)
            if (countAt(x, y) >= most - most / 50) {
                sum += glm::dvec2(x, y);
                ++count;
            }
    const glm::ivec2 middle = count > 0 ? glm::ivec2(glm::round(sum / count)) : glm::ivec2(0);
    return glm::clamp(middle, glm::ivec2(0), glm::max(whole - size, glm::ivec2(0)));
}

Picture cutOut(const Picture& image, glm::ivec2 corner, glm::ivec2 size) {
    Picture picture{size.x, size.y, {}};
    for (int y = 0; y < size.y; ++y) {
        const auto row =
            image.rgba.begin() + static_cast<std::ptrdiff_t>(4 * at(corner.x, corner.y + y, image.width));
        picture.rgba.insert(picture.rgba.end(), row, row + 4 * size.x);
    }
    return picture;
}

Picture differencePicture(const Picture& test, const Picture& reference) {
    const std::vector<glm::vec3> a = pixelsOf(test), b = pixelsOf(reference);
    const std::vector<float> error =
        reflection::flip({test.width, test.height, a}, {reference.width, reference.height, b});
    Picture picture{test.width, test.height, std::vector<std::uint8_t>(4 * error.size(), 255)};
    for (std::size_t i = 0; i < error.size(); ++i) errorColour(error[i], &picture.rgba[4 * i]);
    return picture;
}

}  // namespace app
