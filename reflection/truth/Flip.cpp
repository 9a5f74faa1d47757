// LDR-FLIP. Source: Andersson, Nilsson, Akenine-Moller, Oskarsson, Astrom, Fairchild: FLIP: A Difference
// Evaluator for Alternating Images, High Performance Graphics 2020. Numbers in comments are the paper's
// sections. Departure: every two-dimensional filter is done as two one-dimensional ones (or a sum of two such
// pairs), which is the same sum in another order.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
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

/// All that the comparison needs of one image.
struct Seen {
    std::vector<glm::vec3> lab;  ///< after the eye's blur, Hunt-adjusted
    Features features;
};

Seen see(const ImageView& image, const Colours& colours, double pixelsPerDegree) {
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
        const glm::vec3& p = image.pixels[i];
        const glm::vec3 v = colours.whiteRelativeFromRgb *
                            glm::vec3(linearFromSrgb(p.x), linearFromSrgb(p.y), linearFromSrgb(p.z));
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

    Seen seen{std::vector<glm::vec3>(lightness.values.size()), detectFeatures(lightness, pixelsPerDegree)};
    forRows([&](std::size_t i) {
        const float middle = (y.values[i] + 16) / 116;
        const glm::vec3 v(middle + cx.values[i] / 500, middle, middle - cz.values[i] / 200);
        seen.lab[i] = huntLab(glm::clamp(colours.rgbFromWhiteRelative * v, 0.0f, 1.0f), colours);
    });
    return seen;
}

}  // namespace

std::vector<float> flip(const ImageView& test, const ImageView& reference, float pixelsPerDegree) {
    const std::size_t count = static_cast<std::size_t>(std::max(test.width, 0)) *
                              static_cast<std::size_t>(std::max(test.height, 0));
    if (count == 0 || test.width != reference.width || test.height != reference.height ||
        test.pixels.size() < count || reference.pixels.size() < count || !(pixelsPerDegree > 0) ||
        !std::isfinite(pixelsPerDegree))
        return {};
    const Colours colours = colourMatrices();
    const Seen seenTest = see(test, colours, pixelsPerDegree);
    const Seen seenReference = see(reference, colours, pixelsPerDegree);
    // 4.1.3: the largest error that two sRGB colours can have lies between green and blue.
    const float largest = std::pow(hyab(huntLab({0, 1, 0}, colours), huntLab({0, 0, 1}, colours)), qc);
    const float knee = pc * largest;

    std::vector<float> error(count);
    tbb::parallel_for(0, test.height, [&](int row) {
        const std::size_t begin = static_cast<std::size_t>(row) * static_cast<std::size_t>(test.width);
        for (std::size_t i = begin; i < begin + static_cast<std::size_t>(test.width); ++i) {
            const float distance = std::pow(hyab(seenTest.lab[i], seenReference.lab[i]), qc);
            const float colour = distance < knee
                                     ? pt / knee * distance
                                     : std::min(1.0f, pt + (distance - knee) / (largest - knee) * (1 - pt));
            const float feature = std::max(
                std::abs(seenTest.features.edge.values[i] - seenReference.features.edge.values[i]),
                std::abs(seenTest.features.point.values[i] - seenReference.features.point.values[i]));
            // A response's length is at most sqrt(2); rounding must not take the exponent below zero.
            const float featureError = std::min(1.0f, std::pow(feature / std::numbers::sqrt2_v<float>, qf));
            error[i] = std::pow(colour, 1 - featureError);
        }
    });
    return error;
}

}  // namespace reflection
