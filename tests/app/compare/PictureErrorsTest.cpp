#include "app/compare/PictureErrorsOf.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "app/compare/PictureStrip.h"
#include "app/frame/ToneMap.h"
#include "tests/reflection/tracing/SeededRandom.h"

namespace app {
namespace {

Picture noise(int width, int height, std::uint64_t seed) {
    reflection::SeededRandom random(seed);
    Picture picture{width, height, {}};
    for (int i = 0; i < 4 * width * height; ++i)
        picture.rgba.push_back(static_cast<std::uint8_t>(random.below(256)));
    return picture;
}

std::vector<glm::vec3> colours(const Picture& p) {
    std::vector<glm::vec3> out;
    for (std::size_t i = 0; i < p.rgba.size(); i += 4)
        out.push_back(glm::vec3(p.rgba[i], p.rgba[i + 1], p.rgba[i + 2]) / 255.0f);
    return out;
}

TEST(PictureErrorsTest, aWindowAroundTheMaskGivesTheErrorsOfTheWholePicture) {
    constexpr int width = 150, height = 110;
    const Picture test = noise(width, height, 1), truth = noise(width, height, 2);
    const Picture testBefore = noise(width, height, 3), truthBefore = noise(width, height, 4);
    std::vector<unsigned char> mask(width * height), before(width * height);
    for (int y = 50; y < 60; ++y)
        for (int x = 70; x < 90; ++x) {
            mask[static_cast<std::size_t>(y * width + x)] = 1;
            before[static_cast<std::size_t>(y * width + x - 5)] = 1;
        }
    const ErrorWindow window(mask, before, {width, height});
    ASSERT_FALSE(window.empty());
    EXPECT_LT(window.mask().size(), mask.size());
    const Judge judge(window, truth, &truthBefore, {}, true);
    const PictureErrors errors = judge.errorsOf(Judged(window, test, &testBefore, {}));

    const auto a = colours(test), b = colours(truth), c = colours(testBefore), d = colours(truthBefore);
    const reflection::ImageView va{width, height, a}, vb{width, height, b}, vc{width, height, c},
        vd{width, height, d};
    std::vector<unsigned char> both(mask.size());
    for (std::size_t i = 0; i < both.size(); ++i) both[i] = mask[i] & before[i];
    EXPECT_NEAR(errors.psnr, reflection::psnr(va, vb, mask), 1e-9);
    EXPECT_NEAR(errors.flip, reflection::meanError(reflection::flip(va, vb), mask), 1e-6);
    EXPECT_NEAR(errors.ssim, reflection::ssim(va, vb, mask), 1e-6);
    EXPECT_NEAR(errors.flicker, reflection::flicker(va, vc, vb, vd, both), 1e-9);
    EXPECT_TRUE(std::isnan(errors.hdrFlip)) << "there was no radiance";
}

TEST(PictureErrorsTest, withoutAnythingThatMirrorsThereIsNothingToJudge) {
    EXPECT_TRUE(ErrorWindow(std::vector<unsigned char>(20), {}, {5, 4}).empty());
}

TEST(PictureErrorsTest, theRichestWindowHoldsMostOfTheMask) {
    std::vector<unsigned char> mask(40 * 30);
    for (int y = 20; y < 26; ++y)
        for (int x = 30; x < 36; ++x) mask[static_cast<std::size_t>(y * 40 + x)] = 1;
    const glm::ivec2 corner = richestWindow(mask, {40, 30}, {10, 8});
    EXPECT_LE(corner.x, 30);
    EXPECT_GE(corner.x + 10, 36);
    EXPECT_LE(corner.y, 20);
    EXPECT_GE(corner.y + 8, 26);
    const Picture whole = noise(40, 30, 5), cut = cutOut(whole, corner, {10, 8});
    EXPECT_EQ(cut.rgba.size(), 4u * 80);
    EXPECT_EQ(cut.rgba[4 * 11],
              whole.rgba[static_cast<std::size_t>(4 * ((corner.y + 1) * 40 + corner.x + 1))]);
}

TEST(PictureErrorsTest, errorColoursGrowBrighter) {
    int last = -1;
    for (int i = 0; i <= 100; ++i) {
        std::uint8_t rgb[3];
        errorColour(static_cast<float>(i) / 100, rgb);
        const int brightness = 2126 * rgb[0] + 7152 * rgb[1] + 722 * rgb[2];
        EXPECT_GT(brightness, last) << i;
        last = brightness;
    }
    std::uint8_t nan[3], one[3];
    errorColour(NAN, nan);
    errorColour(1, one);
    EXPECT_TRUE(std::equal(nan, nan + 3, one));
}

TEST(ToneMapTest, radianceShownAsIsItsInverse) {
    for (const float exposure : {0.25f, 1.0f, 3.0f})
        for (float radiance = 0.01f; radiance < 20; radiance *= 1.3f) {
            const glm::vec3 shown = toneMap(glm::vec3(radiance), exposure);
            // Where the curve is flat a rounding is much radiance; the darkest is all shown as black.
            if (shown.x > 0.99f || shown.x <= 0) continue;
            EXPECT_NEAR(radianceShownAs(shown, exposure).x, radiance, 2e-3f * radiance + 1e-4f) << exposure;
        }
    EXPECT_TRUE(std::isfinite(radianceShownAs(glm::vec3(1), 1).x));
}

}  // namespace
}  // namespace app
