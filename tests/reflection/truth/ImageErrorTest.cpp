#include "reflection/truth/ImageError.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

namespace reflection {
namespace {

struct Image {
    int width;
    int height;
    std::vector<glm::vec3> pixels;

    Image(int w, int h, glm::vec3 colour = glm::vec3(0))
        : width(w), height(h), pixels(static_cast<std::size_t>(w * h), colour) {}
    glm::vec3& at(int x, int y) { return pixels[static_cast<std::size_t>(y * width + x)]; }
    glm::vec3 clamped(int x, int y) const {
        return pixels[static_cast<std::size_t>(std::clamp(y, 0, height - 1) * width +
                                               std::clamp(x, 0, width - 1))];
    }
    ImageView view() const { return {width, height, pixels}; }
};

Image noise(int width, int height, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    Image image(width, height);
    for (glm::vec3& p : image.pixels)
        for (int c = 0; c < 3; ++c) p[c] = static_cast<float>(random() >> 40) / static_cast<float>(1 << 24);
    return image;
}

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

}  // namespace oracle

TEST(PsnrTest, oneStepOfATenthIsTwentyDecibels) {
    const Image a(8, 4, glm::vec3(0.5f));
    const Image b(8, 4, glm::vec3(0.6f));
    EXPECT_NEAR(psnr(a.view(), b.view()), 20, 1e-5);  // 0.6f - 0.5f is 0.1 to 2.4e-8
    EXPECT_EQ(psnr(a.view(), b.view()), psnr(b.view(), a.view()));
    EXPECT_EQ(psnr(a.view(), a.view()), std::numeric_limits<double>::infinity());
}

TEST(PsnrTest, onlyThePixelsOfTheMaskCount) {
    Image a(4, 1);
    Image b = a;
    b.at(0, 0) = glm::vec3(1);
    const std::vector<unsigned char> first{1, 0, 0, 0}, others{0, 1, 1, 1}, none{0, 0, 0, 0};
    EXPECT_EQ(psnr(a.view(), b.view(), first), 0);
    EXPECT_EQ(psnr(a.view(), b.view(), others), std::numeric_limits<double>::infinity());
    EXPECT_TRUE(std::isnan(psnr(a.view(), b.view(), none)));
    EXPECT_NEAR(psnr(a.view(), b.view()), 10 * std::log10(4), 1e-12);
}

TEST(PsnrTest, unequalSizesGiveNaN) {
    EXPECT_TRUE(std::isnan(psnr(Image(2, 3).view(), Image(3, 2).view())));
    EXPECT_TRUE(std::isnan(psnr({}, {})));
    EXPECT_TRUE(std::isnan(ssim(Image(12, 13).view(), Image(13, 12).view())));
    EXPECT_TRUE(flip(Image(2, 3).view(), Image(3, 2).view()).empty());
    EXPECT_TRUE(flip({}, {}).empty());
    EXPECT_TRUE(flip(Image(2, 2).view(), Image(2, 2).view(), 0).empty());
}

TEST(SsimTest, constantImagesLeaveTheLuminanceTermAlone) {
    const Image a(16, 16, glm::vec3(0.2f));
    const Image b(16, 16, glm::vec3(0.6f));
    const double expected = (2 * 0.2 * 0.6 + 1e-4) / (0.2 * 0.2 + 0.6 * 0.6 + 1e-4);
    // Variances of constants vanish up to float rounding, 1e-7 beside c2 = 9e-4.
    EXPECT_NEAR(ssim(a.view(), b.view()), expected, 1e-3);
    EXPECT_NEAR(ssim(a.view(), a.view()), 1, 1e-6);
    EXPECT_TRUE(std::isnan(ssim(Image(10, 20).view(), Image(10, 20).view())));
}

TEST(SsimTest, agreesWithTheDefinitionWrittenOut) {
    const Image a = noise(17, 15, 1);
    Image b = a;
    const Image other = noise(17, 15, 2);
    for (std::size_t i = 0; i < b.pixels.size(); ++i)
        b.pixels[i] = 0.7f * a.pixels[i] + 0.3f * other.pixels[i];
    const auto luma = [](const glm::vec3& p) { return 0.299 * p.x + 0.587 * p.y + 0.114 * p.z; };
    double sum = 0;
    int count = 0;
    for (int y = 5; y < 10; ++y)
        for (int x = 5; x < 12; ++x) {
            double w = 0, ma = 0, mb = 0, aa = 0, bb = 0, ab = 0;
            for (int j = -5; j <= 5; ++j)
                for (int i = -5; i <= 5; ++i) {
                    const double g = std::exp(-(i * i + j * j) / (2 * 1.5 * 1.5));
                    const double p = luma(a.clamped(x + i, y + j)), q = luma(b.clamped(x + i, y + j));
                    w += g;
                    ma += g * p;
                    mb += g * q;
                    aa += g * p * p;
                    bb += g * q * q;
                    ab += g * p * q;
                }
            ma /= w;
            mb /= w;
            const double va = aa / w - ma * ma, vb = bb / w - mb * mb, cov = ab / w - ma * mb;
            sum += (2 * ma * mb + 1e-4) * (2 * cov + 9e-4) / ((ma * ma + mb * mb + 1e-4) * (va + vb + 9e-4));
            ++count;
        }
    // Float sums over 121 weights: relative 1e-6 of moments near 0.3, beside variances near 0.03.
    EXPECT_NEAR(ssim(a.view(), b.view()), sum / count, 1e-4);
}

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

TEST(MeanErrorTest, masksAndEmptiness) {
    const std::vector<float> error{1, 2, 6};
    EXPECT_DOUBLE_EQ(meanError(error), 3);
    const std::vector<unsigned char> two{1, 1, 0}, none{0, 0, 0};
    EXPECT_DOUBLE_EQ(meanError(error, two), 1.5);
    EXPECT_TRUE(std::isnan(meanError(error, none)));
    EXPECT_TRUE(std::isnan(meanError({})));
}

}  // namespace
}  // namespace reflection
