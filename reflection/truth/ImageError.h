#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace reflection {

/// A view of an image in memory: linear or display-encoded RGB, row-major, top row first.
struct ImageView {
    int width = 0;
    int height = 0;
    std::span<const glm::vec3> pixels;  ///< width * height
};

/// Which pixels count: one byte a pixel, 0 = leave out; empty = all count.
using PixelMask = std::span<const unsigned char>;

/// Peak signal-to-noise ratio in dB for values with peak 1; +infinity for equal images, NaN for an empty mask
/// or unequal sizes.
double psnr(const ImageView& test, const ImageView& reference, PixelMask mask = {});

/// Mean structural similarity (Wang et al. 2004: 11x11 Gaussian, sigma 1.5, luminance 0.299 0.587 0.114) over
/// the pixels whose whole window lies inside the image; NaN where there is none, or for unequal sizes.
double ssim(const ImageView& test, const ImageView& reference, PixelMask mask = {});

/// LDR-FLIP error of every pixel, 0..1 (Andersson et al. 2020), for sRGB-encoded images. Empty for
/// unequal or empty images and for a pixelsPerDegree that is not positive. Equal images give 0 everywhere;
/// NaN pixels give NaN around them.
/// `pixelsPerDegree`: 67 is the authors' default (0.7 m from a 24 inch 4K display).
std::vector<float> flip(const ImageView& test, const ImageView& reference, float pixelsPerDegree = 67);

/// Mean over the mask of a per-pixel error; NaN for an empty mask.
double meanError(std::span<const float> error, PixelMask mask = {});

}  // namespace reflection
