// LDR-FLIP. Source: Andersson, Nilsson, Akenine-Moller, Oskarsson, Astrom, Fairchild: FLIP: A Difference
// Evaluator for Alternating Images, High Performance Graphics 2020. Numbers in comments are the paper's
// sections. HDR-FLIP: Andersson, Nilsson, Shirley, Akenine-Moller: Visualizing Errors in Rendered High
// Dynamic Range Images, Eurographics 2021 short papers: the greatest LDR-FLIP error over a range of
// exposures. Departure: every two-dimensional filter is done as two one-dimensional ones (or a sum of two
// such pairs), which is the same sum in another order.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <numbers>

#include "reflection/truth/ImageError.h"
#include "reflection/truth/SeparableFilter.h"

namespace reflection {

namespace {

// 4.1.2, 4.1.3 and 4.2: the exponents of colour and features, and where large colour errors are compressed.
constexpr float qc = 0.7f;
constexpr float qf = 0.5f;
constexpr float pc = 0.4f;
constexpr float pt = 0.95f;
/// 4.2.1: peak-to-trough width, in degrees, of the human edge detector.
constexpr double edgeWidth = 0.082;

/// One term a sqrt(pi/b) exp(-pi^2 d^2 / b) of a contrast sensitivity function in space, d in degrees.
/// Table 1.
struct CsfTerm {
    double a;
    double b;
};
constexpr std::array<CsfTerm, 1> achromaticCsf{{{1, 0.0047}}};
constexpr std::array<CsfTerm, 1> redGreenCsf{{{1, 0.0053}}};
constexpr std::array<CsfTerm, 2> blueYellowCsf{{{34.1, 0.04}, {13.5, 0.025}}};

/// Linear sRGB primaries in CIE XYZ under D65, columns R G B, as exact fractions.
const glm::dmat3 xyzFromRgb(10135552.0 / 24577794, 2613072.0 / 12288897, 1425312.0 / 73733382,  //
                            8788810.0 / 24577794, 8788810.0 / 12288897, 8788810.0 / 73733382,   //
                            4435075.0 / 24577794, 887015.0 / 12288897, 70074185.0 / 73733382);

struct Colours {
    glm::mat3 whiteRelativeFromRgb;  ///< XYZ divided by the white point
    glm::mat3 rgbFromWhiteRelative;
};

Colours colourMatrices() {
    const glm::dvec3 white = xyzFromRgb * glm::dvec3(1);
    const glm::dmat3 scale(1 / white.x, 0, 0, 0, 1 / white.y, 0, 0, 0, 1 / white.z);
    const glm::dmat3 relative = scale * xyzFromRgb;
    return {glm::mat3(relative), glm::mat3(glm::inverse(relative))};
}

float linearFromSrgb(float v) {
    return v > 0.04045f ? std::pow((v + 0.055f) / 1.055f, 2.4f) : v / 12.92f;
}

/// CIELAB's cube root with its straight piece near zero.
float labCurve(float v) {
    constexpr float delta = 6.0f / 29;
    return v > delta * delta * delta ? std::cbrt(v) : v / (3 * delta * delta) + 4.0f / 29;
}

/// L*a*b* with chroma scaled by lightness (4.1.2, the Hunt effect).
glm::vec3 huntLab(const glm::vec3& rgb, const Colours& colours) {
    const glm::vec3 v = colours.whiteRelativeFromRgb * rgb;
    const glm::vec3 f(labCurve(v.x), labCurve(v.y), labCurve(v.z));
    const float lightness = 116 * f.y - 16;
    return {lightness, 0.01f * lightness * 500 * (f.x - f.y), 0.01f * lightness * 200 * (f.y - f.z)};
}

float hyab(const glm::vec3& p, const glm::vec3& q) {
    return std::abs(p.x - q.x) + std::hypot(p.y - q.y, p.z - q.z);
}

/// Filters a channel by a contrast sensitivity function whose weights sum to 1 over a square of the given
/// radius.
template <std::size_t terms>
Channel applyCsf(const Channel& channel, const std::array<CsfTerm, terms>& csf, int radius,
                 double pixelsPerDegree) {
    std::array<double, terms> share{};
    double total = 0;
    for (std::size_t t = 0; t < terms; ++t) {
        // In one dimension exp(-pi^2 d^2 / b); over the square the sum is that of a row, squared.
        double row = 0;
        for (int x = -radius; x <= radius; ++x) {
            const double d = x / pixelsPerDegree;
            row += std::exp(-std::numbers::pi * std::numbers::pi * d * d / csf[t].b);
        }
        share[t] = csf[t].a * std::sqrt(std::numbers::pi / csf[t].b) * row * row;
        total += share[t];
    }
    Channel result(channel.width, channel.height);
    for (std::size_t t = 0; t < terms; ++t) {
        const double sigma = std::sqrt(csf[t].b / 2) / std::numbers::pi * pixelsPerDegree;
        // Seven standard deviations out a weight is below 3e-11 of the middle one: nothing in single
        // precision.
        const int own = std::min(radius, static_cast<int>(std::ceil(7 * sigma)));
        const Kernel kernel = gaussianKernel(sigma, own);
        const Channel part = filterColumns(filterRows(channel, kernel), kernel);
        const auto weight = static_cast<float>(share[t] / total);
        for (std::size_t i = 0; i < part.values.size(); ++i) result.values[i] += weight * part.values[i];
    }
    return result;
}

/// Scales the positive weights to the sum 1 and the negative ones to -1.
Kernel signedUnit(const std::vector<double>& weights) {
    double positive = 0;
    double negative = 0;
    for (double w : weights) (w > 0 ? positive : negative) += w;
    Kernel kernel;
    for (double w : weights)
        kernel.push_back(static_cast<float>(w > 0 ? w / positive : (w < 0 ? w / -negative : 0)));
    return kernel;
}

/// Lengths of the edge and point responses at every pixel (4.2.1).
struct Features {
    Channel edge;
    Channel point;
};

}  // namespace

/// All that the comparison needs of one image.
struct FlipImage::Seen {
    std::vector<glm::vec3> lab;  ///< after the eye's blur, Hunt-adjusted
    Features features;
};

namespace {

Features detectFeatures(const Channel& lightness, double pixelsPerDegree) {
    const double sigma = 0.5 * edgeWidth * pixelsPerDegree;
    const int radius = static_cast<int>(std::ceil(3 * sigma));
    std::vector<double> first;
    std::vector<double> second;
    for (int x = -radius; x <= radius; ++x) {
        const double g = std::exp(-x * x / (2 * sigma * sigma));
        first.push_back(-x * g);
        second.push_back((x * x / (sigma * sigma) - 1) * g);
    }
    const Kernel smooth = gaussianKernel(sigma, radius);
    const Kernel edge = signedUnit(first);
    const Kernel point = signedUnit(second);
    const Channel smoothRows = filterRows(lightness, smooth);
    const auto length = [&](const Kernel& kernel) {
        Channel across = filterColumns(filterRows(lightness, kernel), smooth);
        const Channel down = filterColumns(smoothRows, kernel);
        for (std::size_t i = 0; i < across.values.size(); ++i) {
            const float x = across.values[i];
            const float y = down.values[i];
            across.values[i] = std::sqrt(x * x + y * y);
        }
        return across;
    };
    return {length(edge), length(point)};
}

/// From linear colours in 0..1, `linear(i)` for pixel i.
template <typename Linear>
FlipImage::Seen see(const ImageView& image, const Colours& colours, double pixelsPerDegree,
                    const Linear& linear) {
    Channel y(image.width, image.height), cx(image.width, image.height), cz(image.width, image.height),
        lightness(image.width, image.height);
    const auto width = static_cast<std::size_t>(image.width);
    const auto forRows = [&](auto&& pixel) {
        tbb::parallel_for(0, image.height, [&](int row) {
            for (std::size_t i = static_cast<std::size_t>(row) * width;
                 i < (static_cast<std::size_t>(row) + 1) * width; ++i)
                pixel(i);
        });
    };
    forRows([&](std::size_t i) {
        const glm::vec3 v = colours.whiteRelativeFromRgb * linear(i);
        lightness.values[i] = v.y;  // (Y + 16) / 116, since Y = 116 v.y - 16
        y.values[i] = 116 * v.y - 16;
        cx.values[i] = 500 * (v.x - v.y);
        cz.values[i] = 200 * (v.y - v.z);
    });
    double widest = 0;
    for (const CsfTerm& term : blueYellowCsf) widest = std::max(widest, term.b);
    const int radius =
        static_cast<int>(std::ceil(3 * std::sqrt(widest / 2) / std::numbers::pi * pixelsPerDegree));
    y = applyCsf(y, achromaticCsf, radius, pixelsPerDegree);
    cx = applyCsf(cx, redGreenCsf, radius, pixelsPerDegree);
    cz = applyCsf(cz, blueYellowCsf, radius, pixelsPerDegree);

    FlipImage::Seen seen{std::vector<glm::vec3>(lightness.values.size()),
                         detectFeatures(lightness, pixelsPerDegree)};
    forRows([&](std::size_t i) {
        const float middle = (y.values[i] + 16) / 116;
        const glm::vec3 v(middle + cx.values[i] / 500, middle, middle - cz.values[i] / 200);
        seen.lab[i] = huntLab(glm::clamp(colours.rgbFromWhiteRelative * v, 0.0f, 1.0f), colours);
    });
    return seen;
}

/// FLIP's error of every pixel from what is seen of two images of one size.
std::vector<float> compare(const FlipImage::Seen& test, const FlipImage::Seen& reference, int width,
                           int height) {
    const Colours colours = colourMatrices();
    // 4.1.3: the largest error that two sRGB colours can have lies between green and blue.
    const float largest = std::pow(hyab(huntLab({0, 1, 0}, colours), huntLab({0, 0, 1}, colours)), qc);
    const float knee = pc * largest;

    std::vector<float> error(test.lab.size());
    tbb::parallel_for(0, height, [&](int row) {
        const std::size_t begin = static_cast<std::size_t>(row) * static_cast<std::size_t>(width);
        for (std::size_t i = begin; i < begin + static_cast<std::size_t>(width); ++i) {
            const float distance = std::pow(hyab(test.lab[i], reference.lab[i]), qc);
            const float colour = distance < knee
                                     ? pt / knee * distance
                                     : std::min(1.0f, pt + (distance - knee) / (largest - knee) * (1 - pt));
            const float feature =
                std::max(std::abs(test.features.edge.values[i] - reference.features.edge.values[i]),
                         std::abs(test.features.point.values[i] - reference.features.point.values[i]));
            // A response's length is at most sqrt(2); rounding must not take the exponent below zero.
            const float featureError = std::min(1.0f, std::pow(feature / std::numbers::sqrt2_v<float>, qf));
            error[i] = std::pow(colour, 1 - featureError);
        }
    });
    return error;
}

std::size_t pixelCount(const ImageView& image) {
    return static_cast<std::size_t>(std::max(image.width, 0)) *
           static_cast<std::size_t>(std::max(image.height, 0));
}

bool visible(const ImageView& image, float pixelsPerDegree) {
    return pixelCount(image) > 0 && image.pixels.size() >= pixelCount(image) && pixelsPerDegree > 0 &&
           std::isfinite(pixelsPerDegree);
}

// The tone mapping that HDR-FLIP takes by default: the ACES curve as Narkowicz fitted it, exposure 0.6
// included, (k0 x^2 + k1 x) / (k3 x^2 + k4 x + k5).
constexpr double k0 = 0.6 * 0.6 * 2.51, k1 = 0.6 * 0.03, k3 = 0.6 * 0.6 * 2.43, k4 = 0.6 * 0.59, k5 = 0.14;
/// Where the curve starts to saturate, by which the exposures are chosen.
constexpr double kneeOfTheCurve = 0.85;

glm::vec3 shownByAces(const glm::vec3& radiance) {
    glm::vec3 shown;
    for (int c = 0; c < 3; ++c) {
        const double x = static_cast<double>(radiance[c]);
        shown[c] =
            static_cast<float>(std::clamp((k0 * x * x + k1 * x) / (k3 * x * x + k4 * x + k5), 0.0, 1.0));
    }
    return shown;
}

/// The brightness that the curve shows as t: the greater root of a quadratic.
float brightnessShownAs(double t) {
    const double a = k0 - t * k3, b = (k1 - t * k4) / a, c = -t * k5 / a;
    return static_cast<float>(-0.5 * b + std::sqrt(0.25 * b * b - c));
}

}  // namespace

FlipImage::FlipImage(const ImageView& image, float pixelsPerDegree)
    : width_(image.width), height_(image.height), pixelsPerDegree_(pixelsPerDegree) {
    if (!visible(image, pixelsPerDegree)) return;
    seen_ = std::make_unique<Seen>(see(image, colourMatrices(), pixelsPerDegree, [&](std::size_t i) {
        const glm::vec3& p = image.pixels[i];
        return glm::vec3(linearFromSrgb(p.x), linearFromSrgb(p.y), linearFromSrgb(p.z));
    }));
}
FlipImage::FlipImage() = default;
FlipImage::~FlipImage() = default;
FlipImage::FlipImage(FlipImage&&) noexcept = default;
FlipImage& FlipImage::operator=(FlipImage&&) noexcept = default;

std::vector<float> flip(const FlipImage& test, const FlipImage& reference) {
    if (!test.seen_ || !reference.seen_ || test.width_ != reference.width_ ||
        test.height_ != reference.height_ || test.pixelsPerDegree_ != reference.pixelsPerDegree_)
        return {};
    return compare(*test.seen_, *reference.seen_, test.width_, test.height_);
}

std::vector<float> flip(const ImageView& test, const ImageView& reference, float pixelsPerDegree) {
    return flip(FlipImage(test, pixelsPerDegree), FlipImage(reference, pixelsPerDegree));
}

std::optional<FlipExposures> flipExposures(const ImageView& reference) {
    if (!visible(reference, 1)) return std::nullopt;
    std::vector<float> luminance;
    luminance.reserve(pixelCount(reference));
    for (std::size_t i = 0; i < pixelCount(reference); ++i) {
        const glm::vec3& p = reference.pixels[i];
        const float y = 0.2126f * p.x + 0.7152f * p.y + 0.0722f * p.z;
        if (!std::isfinite(y)) return std::nullopt;
        luminance.push_back(y);
    }
    std::sort(luminance.begin(), luminance.end());
    const std::size_t half = luminance.size() / 2;
    const float median =
        luminance.size() % 2 == 1 ? luminance[half] : 0.5f * (luminance[half - 1] + luminance[half]);
    // The authors' floor for dark images.
    constexpr float darkest = std::numeric_limits<float>::epsilon();
    FlipExposures exposures;
    exposures.start = std::log2(brightnessShownAs(kneeOfTheCurve) / std::max(luminance.back(), darkest));
    exposures.stop = std::log2(brightnessShownAs(kneeOfTheCurve) / std::max(median, darkest));
    exposures.count = std::max(2, static_cast<int>(std::ceil(exposures.stop - exposures.start)));
    return exposures;
}

std::vector<float> hdrFlip(const ImageView& test, const ImageView& reference, float pixelsPerDegree,
                           const std::optional<FlipExposures>& given) {
    if (!visible(test, pixelsPerDegree) || !visible(reference, pixelsPerDegree) ||
        test.width != reference.width || test.height != reference.height)
        return {};
    const std::optional<FlipExposures> exposures = given ? given : flipExposures(reference);
    if (!exposures || exposures->count < 1) return {};
    const Colours colours = colourMatrices();
    std::vector<float> worst(pixelCount(test), 0.0f);
    for (int k = 0; k < exposures->count; ++k) {
        const float share =
            exposures->count == 1 ? 0 : static_cast<float>(k) / static_cast<float>(exposures->count - 1);
        const float scale = std::exp2(exposures->start + share * (exposures->stop - exposures->start));
        const auto seen = [&](const ImageView& image) {
            return see(image, colours, pixelsPerDegree,
                       [&](std::size_t i) { return shownByAces(scale * image.pixels[i]); });
        };
        const std::vector<float> error = compare(seen(test), seen(reference), test.width, test.height);
        for (std::size_t i = 0; i < worst.size(); ++i)
            // Written so that NaN is kept.
            if (!(error[i] <= worst[i])) worst[i] = error[i];
    }
    return worst;
}

}  // namespace reflection
