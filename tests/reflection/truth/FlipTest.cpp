#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "reflection/truth/ImageError.h"
#include "tests/reflection/truth/TestImage.h"

namespace reflection {
namespace {

using test::Image;
using test::noise;

/// FLIP as its authors write it down: square filters, double precision, nothing separated, nothing cut.
namespace oracle {

using Rgb = std::array<double, 3>;

Rgb xyzOf(const Rgb& c) {
    return {10135552.0 / 24577794 * c[0] + 8788810.0 / 24577794 * c[1] + 4435075.0 / 24577794 * c[2],
            2613072.0 / 12288897 * c[0] + 8788810.0 / 12288897 * c[1] + 887015.0 / 12288897 * c[2],
            1425312.0 / 73733382 * c[0] + 8788810.0 / 73733382 * c[1] + 70074185.0 / 73733382 * c[2]};
}
// The white point and the inverse matrix as published, rounded: the test's tolerance covers their last digit.
const Rgb white{0.950428545, 1.0, 1.088900371};
Rgb rgbOf(const Rgb& v) {
    return {3.241003275 * v[0] - 1.537398934 * v[1] - 0.498615861 * v[2],
            -0.969224334 * v[0] + 1.875930071 * v[1] + 0.041554224 * v[2],
            0.055639423 * v[0] - 0.204011202 * v[1] + 1.057148933 * v[2]};
}
double linear(double s) {
    return s > 0.04045 ? std::pow((s + 0.055) / 1.055, 2.4) : s / 12.92;
}
Rgb ycxcz(const glm::vec3& s) {
    Rgb v = xyzOf({linear(s.x), linear(s.y), linear(s.z)});
    for (std::size_t c = 0; c < 3; ++c) v[c] /= white[c];
    return {116 * v[1] - 16, 500 * (v[0] - v[1]), 200 * (v[1] - v[2])};
}
Rgb huntLab(const Rgb& rgb) {
    Rgb v = xyzOf(rgb);
    for (std::size_t c = 0; c < 3; ++c) {
        v[c] /= white[c];
        v[c] = v[c] > std::pow(6.0 / 29, 3) ? std::cbrt(v[c]) : v[c] / (3 * std::pow(6.0 / 29, 2)) + 4.0 / 29;
    }
    const double l = 116 * v[1] - 16;
    return {l, 0.01 * l * 500 * (v[0] - v[1]), 0.01 * l * 200 * (v[1] - v[2])};
}
double hyab(const Rgb& p, const Rgb& q) {
    return std::abs(p[0] - q[0]) + std::hypot(p[1] - q[1], p[2] - q[2]);
}

double csf(double a1, double b1, double a2, double b2, double squaredDegrees) {
    constexpr double pi = std::numbers::pi;
    return a1 * std::sqrt(pi / b1) * std::exp(-pi * pi * squaredDegrees / b1) +
           a2 * std::sqrt(pi / b2) * std::exp(-pi * pi * squaredDegrees / b2);
}

Rgb blurredLab(const Image& image, int x, int y, double ppd) {
    const int r =
        static_cast<int>(std::ceil(3 * std::sqrt(0.04 / (2 * std::numbers::pi * std::numbers::pi)) * ppd));
    Rgb sum{}, weights{};
    for (int j = -r; j <= r; ++j)
        for (int i = -r; i <= r; ++i) {
            const double d = (i * i + j * j) / (ppd * ppd);
            const Rgb w{csf(1, 0.0047, 0, 1e-5, d), csf(1, 0.0053, 0, 1e-5, d),
                        csf(34.1, 0.04, 13.5, 0.025, d)};
            const Rgb v = ycxcz(image.clamped(x + i, y + j));
            for (std::size_t c = 0; c < 3; ++c) {
                sum[c] += w[c] * v[c];
                weights[c] += w[c];
            }
        }
    for (std::size_t c = 0; c < 3; ++c) sum[c] /= weights[c];
    const double m = (sum[0] + 16) / 116;
    Rgb rgb = rgbOf({(m + sum[1] / 500) * white[0], m * white[1], (m - sum[2] / 200) * white[2]});
    for (double& c : rgb) c = std::clamp(c, 0.0, 1.0);
    return huntLab(rgb);
}

/// Length of the gradient (order 1) or of the second derivatives (order 2).
double feature(const Image& image, int x, int y, double ppd, int order) {
    const double sd = 0.5 * 0.082 * ppd;
    const int r = static_cast<int>(std::ceil(3 * sd));
    double positive = 0, negative = 0;
    const auto weight = [&](int i, int j) {
        const double g = std::exp(-(i * i + j * j) / (2 * sd * sd));
        return order == 1 ? -i * g : (i * i / (sd * sd) - 1) * g;
    };
    for (int j = -r; j <= r; ++j)
        for (int i = -r; i <= r; ++i) (weight(i, j) > 0 ? positive : negative) += weight(i, j);
    double across = 0, down = 0;
    for (int j = -r; j <= r; ++j)
        for (int i = -r; i <= r; ++i) {
            const double w = weight(i, j) > 0 ? weight(i, j) / positive : weight(i, j) / -negative;
            across += w * (ycxcz(image.clamped(x + i, y + j))[0] + 16) / 116;
            down += w * (ycxcz(image.clamped(x + j, y + i))[0] + 16) / 116;
        }
    return std::hypot(across, down);
}

double flipAt(const Image& test, const Image& reference, int x, int y, double ppd) {
    const double largest = std::pow(hyab(huntLab({0, 1, 0}), huntLab({0, 0, 1})), 0.7);
    const double distance =
        std::pow(hyab(blurredLab(test, x, y, ppd), blurredLab(reference, x, y, ppd)), 0.7);
    const double knee = 0.4 * largest;
    const double colour =
        distance < knee ? 0.95 / knee * distance : 0.95 + (distance - knee) / (largest - knee) * 0.05;
    const double edges = std::abs(feature(test, x, y, ppd, 1) - feature(reference, x, y, ppd, 1));
    const double points = std::abs(feature(test, x, y, ppd, 2) - feature(reference, x, y, ppd, 2));
    return std::pow(colour, 1 - std::sqrt(std::max(edges, points) / std::sqrt(2.0)));
}

/// The curve of HDR-FLIP: ACES as Narkowicz fitted it, at 0.6 of the exposure.
double aces(double radiance) {
    const double x = 0.6 * radiance;
    return std::clamp(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 0.0, 1.0);
}
/// The radiance that it shows as t, by halving.
double shownAs(double t) {
    double low = 0, high = 100;
    for (int i = 0; i < 100; ++i) (aces(0.5 * (low + high)) < t ? low : high) = 0.5 * (low + high);
    return low;
}
double encoded(double v) {
    return v > 0.0031308 ? 1.055 * std::pow(v, 1 / 2.4) - 0.055 : 12.92 * v;
}
Image shown(const Image& radiance, double stops) {
    Image image = radiance;
    for (glm::vec3& p : image.pixels)
        for (int c = 0; c < 3; ++c)
            p[c] = static_cast<float>(encoded(aces(std::exp2(stops) * static_cast<double>(p[c]))));
    return image;
}

}  // namespace oracle

TEST(FlipTest, equalImagesHaveNoError) {
    const Image a = noise(40, 30, 3);
    for (float e : flip(a.view(), a.view())) EXPECT_EQ(e, 0);
}

TEST(FlipTest, blackAgainstWhiteIsTheValueWorkedByHand) {
    // L* differs by 100, no chroma, no features: 100^0.7 = 25.119. Green to blue in Hunt-adjusted L*a*b* is
    // 203.2, and 203.2^0.7 = 41.27 with its knee at 16.51: 0.95 + 0.05 (25.119 - 16.51) / (41.27 - 16.51) =
    // 0.9674.
    const Image black(12, 9), white(12, 9, glm::vec3(1));
    for (float e : flip(white.view(), black.view())) EXPECT_NEAR(e, 0.9674, 2e-4);
}

TEST(FlipTest, greenAgainstBlueIsTheLargestColourError) {
    const Image green(12, 9, {0, 1, 0}), blue(12, 9, {0, 0, 1});
    for (float e : flip(green.view(), blue.view())) EXPECT_NEAR(e, 1, 1e-4);
}

TEST(FlipTest, agreesWithTheDefinitionWrittenOut) {
    // Flat areas, an edge, single bright and coloured points, and noise at the right: every term of the error
    // is at work.
    Image reference(44, 26, {0.4f, 0.5f, 0.3f});
    for (int y = 0; y < 26; ++y)
        for (int x = 12; x < 44; ++x) reference.at(x, y) = {0.8f, 0.75f, 0.7f};
    Image test = reference;
    test.at(6, 8) = glm::vec3(1);
    test.at(20, 16) = {0.1f, 0.2f, 1};
    for (int y = 0; y < 26; ++y) test.at(12, y) = {0.4f, 0.5f, 0.3f};
    const Image random = noise(14, 26, 5);
    for (int y = 0; y < 26; ++y)
        for (int x = 30; x < 44; ++x) test.at(x, y) = random.clamped(x - 30, y);
    for (const float ppd : {67.0f, 30.0f}) {
        const std::vector<float> error = flip(test.view(), reference.view(), ppd);
        double largest = 0;
        for (int y = 0; y < 26; y += 5)
            for (int x = 0; x < 44; x += 3) {
                const double expected = oracle::flipAt(test, reference, x, y, ppd);
                // Float rounding in filters over values up to 100, and six-digit constants in the oracle; 0.7
                // and 0.5 powers magnify it near zero.
                EXPECT_NEAR(error[static_cast<std::size_t>(y * 44 + x)], expected, 2e-3) << x << "," << y;
                largest = std::max(largest, expected);
            }
        EXPECT_GT(largest, 0.4);
    }
}

TEST(FlipTest, isSymmetricWithinItsRangeAndGrowsWithTheDifference) {
    const Image a = noise(48, 32, 7), b = noise(48, 32, 8);
    const auto ab = flip(a.view(), b.view()), ba = flip(b.view(), a.view());
    for (std::size_t i = 0; i < ab.size(); ++i) {
        EXPECT_FLOAT_EQ(ab[i], ba[i]);
        EXPECT_GE(ab[i], 0);
        EXPECT_LE(ab[i], 1);
    }
    double last = 0;
    for (const float share : {0.1f, 0.3f, 0.6f, 1.0f}) {
        Image mixed = a;
        for (std::size_t i = 0; i < mixed.pixels.size(); ++i)
            mixed.pixels[i] = (1 - share) * a.pixels[i] + share * b.pixels[i];
        const double mean = meanError(flip(mixed.view(), a.view()));
        EXPECT_GT(mean, last);
        last = mean;
    }
}

TEST(FlipTest, imagesSmallerThanTheFilterKeepToTheirBorder) {
    const Image a(1, 1, glm::vec3(0.3f)), b(1, 1, glm::vec3(0.5f));
    const auto small = flip(a.view(), b.view());
    const auto large = flip(Image(30, 30, glm::vec3(0.3f)).view(), Image(30, 30, glm::vec3(0.5f)).view());
    ASSERT_EQ(small.size(), 1u);
    EXPECT_NEAR(small[0], large[450], 1e-5);
}

TEST(FlipTest, imagesLookedAtBeforeGiveTheSame) {
    const Image a = noise(30, 20, 11), b = noise(30, 20, 12);
    const FlipImage seenA(a.view(), 40), seenB(b.view(), 40);
    EXPECT_EQ(flip(seenA, seenB), flip(a.view(), b.view(), 40));
    EXPECT_TRUE(flip(seenA, FlipImage(b.view(), 50)).empty()) << "seen from another distance";
    EXPECT_TRUE(flip(seenA, FlipImage()).empty());
    FlipImage moved = FlipImage(a.view(), 40);
    const FlipImage into = std::move(moved);
    for (const float e : flip(into, seenA)) EXPECT_EQ(e, 0);
}

TEST(HdrFlipTest, exposuresAreThoseOfTheBrightestAndTheMedianPixel) {
    // The curve shows 2.11887 as 0.85: 0.9036 x^2 + 0.018 x = 0.85 (0.8748 x^2 + 0.354 x + 0.14).
    EXPECT_NEAR(oracle::shownAs(0.85), 2.11887, 1e-5);
    Image image(3, 1, glm::vec3(1));
    image.at(0, 0) = glm::vec3(0.01f);
    image.at(2, 0) = glm::vec3(15);
    const auto exposures = flipExposures(image.view());
    ASSERT_TRUE(exposures);
    EXPECT_NEAR(exposures->stop, std::log2(2.11887), 1e-5);
    EXPECT_NEAR(exposures->start, std::log2(2.11887) - std::log2(15), 1e-5);
    EXPECT_EQ(exposures->count, 4);  // log2(15) = 3.907
    const auto flat = flipExposures(Image(4, 4, glm::vec3(1)).view());
    ASSERT_TRUE(flat);
    EXPECT_EQ(flat->count, 2) << "two at least";
    EXPECT_FALSE(flipExposures({}));
    EXPECT_FALSE(flipExposures(Image(1, 1, glm::vec3(INFINITY)).view()));
    const auto black = flipExposures(Image(2, 2).view());
    ASSERT_TRUE(black);
    EXPECT_TRUE(std::isfinite(black->start) && std::isfinite(black->stop));
}

TEST(HdrFlipTest, blackAgainstGreyIsTheValueWorkedByHand) {
    // A flat reference is shown as 0.85 whatever its radiance: L* = 116 cbrt(0.85) - 16 = 93.88, 93.88^0.7 =
    // 24.03, 0.95 + 0.05 (24.03 - 16.51) / (41.27 - 16.51) = 0.9652.
    for (const float radiance : {0.003f, 1.0f, 700.0f}) {
        const Image black(12, 9), grey(12, 9, glm::vec3(radiance));
        const std::vector<float> error = hdrFlip(black.view(), grey.view());
        ASSERT_EQ(error.size(), 108u);
        for (const float e : error) EXPECT_NEAR(e, 0.9652, 2e-4);
        for (const float e : hdrFlip(grey.view(), grey.view())) EXPECT_EQ(e, 0);
    }
    EXPECT_TRUE(hdrFlip(Image(2, 3).view(), Image(3, 2).view()).empty());
    EXPECT_TRUE(hdrFlip(Image(1, 1).view(), Image(1, 1, glm::vec3(NAN)).view()).empty());
}

TEST(HdrFlipTest, agreesWithTheDefinitionWrittenOut) {
    Image reference = noise(22, 18, 21), test = reference;
    for (int y = 0; y < 18; ++y)
        for (int x = 11; x < 22; ++x) reference.at(x, y) *= 30.0f;
    const Image other = noise(22, 18, 22);
    for (std::size_t i = 0; i < test.pixels.size(); ++i)
        test.pixels[i] = 0.8f * reference.pixels[i] + 4.0f * other.pixels[i];
    std::vector<double> luminance;
    for (const glm::vec3& p : reference.pixels)
        luminance.push_back(0.2126 * static_cast<double>(p.x) + 0.7152 * static_cast<double>(p.y) +
                            0.0722 * static_cast<double>(p.z));
    std::sort(luminance.begin(), luminance.end());
    const double knee = oracle::shownAs(0.85);
    const double start = std::log2(knee / luminance.back()),
                 stop = std::log2(knee / (0.5 * (luminance[197] + luminance[198])));
    const int count = static_cast<int>(std::ceil(stop - start));
    ASSERT_GT(count, 3);
    const std::vector<float> error = hdrFlip(test.view(), reference.view(), 20);
    std::vector<Image> shownTest, shownReference;
    for (int k = 0; k < count; ++k) {
        const double stops = start + k * (stop - start) / (count - 1);
        shownTest.push_back(oracle::shown(test, stops));
        shownReference.push_back(oracle::shown(reference, stops));
    }
    for (int y = 0; y < 18; y += 4)
        for (int x = 0; x < 22; x += 3) {
            double expected = 0;
            for (std::size_t k = 0; k < shownTest.size(); ++k)
                expected = std::max(expected, oracle::flipAt(shownTest[k], shownReference[k], x, y, 20));
            EXPECT_NEAR(error[static_cast<std::size_t>(y * 22 + x)], expected, 2e-3) << x << "," << y;
        }
}

}  // namespace
}  // namespace reflection
