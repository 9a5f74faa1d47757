#pragma once

#include <glm/vec3.hpp>
#include <memory>
#include <optional>
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

/// One image as FLIP's eye sees it, kept for comparing it with many others: most of the cost of `flip`.
class FlipImage {
  public:
    FlipImage();  ///< of nothing: compares as empty
    /// sRGB-encoded. An empty image, or a pixelsPerDegree that is not positive, compares as empty.
    explicit FlipImage(const ImageView& image, float pixelsPerDegree = 67);
    ~FlipImage();
    FlipImage(FlipImage&&) noexcept;
    FlipImage& operator=(FlipImage&&) noexcept;

    struct Seen;

  private:
    friend std::vector<float> flip(const FlipImage& test, const FlipImage& reference);
    int width_ = 0, height_ = 0;
    float pixelsPerDegree_ = 0;
    std::unique_ptr<Seen> seen_;
};

/// The same error from images that were looked at before.
std::vector<float> flip(const FlipImage& test, const FlipImage& reference);

/// Exposures at which HDR-FLIP looks, in stops: `count` of them from start to stop, both included.
struct FlipExposures {
    float start = 0, stop = 0;
    int count = 2;
};

/// The authors' choice: from where the reference's brightest pixel to where its median one is shown just
/// before the tone mapping saturates (85 %), a stop apart or less. Nothing for an empty image or one that is
/// not finite.
std::optional<FlipExposures> flipExposures(const ImageView& reference);

/// HDR-FLIP error of every pixel, 0..1 (Andersson et al. 2021), for linear radiance: the greatest LDR-FLIP
/// error over the exposures (those of the reference, unless given), each shown by the ACES curve. Empty where
/// `flip` is empty or no exposures can be chosen. Cost: that of `flip` for each exposure.
std::vector<float> hdrFlip(const ImageView& test, const ImageView& reference, float pixelsPerDegree = 67,
                           const std::optional<FlipExposures>& given = std::nullopt);

/// Flicker: how far the change from one frame to the next is from the truth's own change, the mean of
/// |(now - before) - (truthNow - truthBefore)| over channels and the mask's pixels. 0 for a method whose
/// error stands still on every pixel, whatever its size. NaN for an empty mask or unequal sizes.
double flicker(const ImageView& now, const ImageView& before, const ImageView& truthNow,
               const ImageView& truthBefore, PixelMask mask = {});

/// Mean over the mask of a per-pixel error; NaN for an empty mask.
double meanError(std::span<const float> error, PixelMask mask = {});

}  // namespace reflection
