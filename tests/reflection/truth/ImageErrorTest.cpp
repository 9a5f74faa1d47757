#include "reflection/truth/ImageError.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/reflection/truth/TestImage.h"

namespace reflection {
namespace {

using test::Image;
using test::noise;

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
    EXPECT_TRUE(flip(ImageView{}, ImageView{}).empty());
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

TEST(FlickerTest, isWhatTheDifferenceOfDifferencesComesToByHand) {
    Image before(2, 1, glm::vec3(0.2f)), now(2, 1, glm::vec3(0.5f)), truthBefore(2, 1, glm::vec3(0.3f)),
        truthNow(2, 1, glm::vec3(0.4f));
    // 0.3 against 0.1 at every channel; at the second pixel the method stands still.
    now.at(1, 0) = before.at(1, 0);
    const std::vector<unsigned char> first{1, 0}, second{0, 1}, none{0, 0};
    const auto of = [&](PixelMask mask) {
        return flicker(now.view(), before.view(), truthNow.view(), truthBefore.view(), mask);
    };
    EXPECT_NEAR(of(first), 0.2, 1e-7);
    EXPECT_NEAR(of(second), 0.1, 1e-7);
    EXPECT_NEAR(of({}), 0.15, 1e-7);
    EXPECT_TRUE(std::isnan(of(none)));
    EXPECT_TRUE(std::isnan(flicker(now.view(), before.view(), truthNow.view(), Image(1, 1).view())));
}

TEST(FlickerTest, anErrorThatStandsStillDoesNotFlicker) {
    const Image truthBefore = noise(9, 7, 1), truthNow = noise(9, 7, 2), off = noise(9, 7, 3);
    Image before = truthBefore, now = truthNow;
    for (std::size_t i = 0; i < off.pixels.size(); ++i) {
        before.pixels[i] += off.pixels[i];
        now.pixels[i] += off.pixels[i];
    }
    EXPECT_LT(flicker(now.view(), before.view(), truthNow.view(), truthBefore.view()), 1e-6);
    EXPECT_GT(flicker(now.view(), truthBefore.view(), truthNow.view(), truthBefore.view()), 0.1);
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
