#include "city/model/PatternImages.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace {

using city::Pattern;
using city::PatternImage;

const std::array<PatternImage, static_cast<std::size_t>(Pattern::count)>& patterns() {
    static const auto images = city::paintPatterns();
    return images;
}

int texel(const PatternImage& image, int x, int y, int channel) {
    const int n = image.size;
    return image.rgba[static_cast<std::size_t>((((y + n) % n) * n + (x + n) % n) * 4 + channel)];
}

double mean(const PatternImage& image, int channel) {
    double sum = 0;
    for (std::size_t i = static_cast<std::size_t>(channel); i < image.rgba.size(); i += 4)
        sum += image.rgba[i];
    const std::size_t texels = image.rgba.size() / 4;
    return sum / (255.0 * static_cast<double>(texels));
}

/// Mean step between neighbours across one column or row boundary, `at` texels from the start.
double step(const PatternImage& image, bool vertical, int at) {
    double sum = 0;
    for (int k = 0; k < image.size; ++k) {
        for (int c = 0; c < 3; ++c) {
            sum += vertical ? std::abs(texel(image, k, at, c) - texel(image, k, at - 1, c))
                            : std::abs(texel(image, at, k, c) - texel(image, at - 1, k, c));
        }
    }
    return sum / (3.0 * image.size);
}

/// The sharpest step inside the picture: a seam must not be sharper.
double sharpest(const PatternImage& image, bool vertical) {
    double most = 0;
    for (int at = 1; at < image.size; ++at) most = std::max(most, step(image, vertical, at));
    return most;
}

}  // namespace

TEST(PatternImages, everyPatternIsASquarePowerOfTwo) {
    for (const PatternImage& image : patterns()) {
        EXPECT_GE(image.size, 64);
        EXPECT_EQ(image.size & (image.size - 1), 0);
        EXPECT_EQ(image.rgba.size(),
                  static_cast<std::size_t>(image.size) * static_cast<std::size_t>(image.size) * 4);
    }
}

TEST(PatternImages, seamsAreNoSharperThanThePictures) {
    for (std::size_t k = 0; k < patterns().size(); ++k) {
        for (const bool vertical : {false, true}) {
            const double limit = std::max(sharpest(patterns()[k], vertical), 3.0);
            EXPECT_LE(step(patterns()[k], vertical, 0), 1.05 * limit)
                << "pattern " << k << (vertical ? " v" : " u");
        }
    }
}

TEST(PatternImages, tintedPatternsAreBright) {
    for (const Pattern p :
         {Pattern::plain, Pattern::asphalt, Pattern::pavement, Pattern::grass, Pattern::soil, Pattern::wall,
          Pattern::metal, Pattern::marking, Pattern::bark, Pattern::foliage}) {
        const PatternImage& image = patterns()[static_cast<std::size_t>(p)];
        for (int c = 0; c < 3; ++c) {
            EXPECT_GT(mean(image, c), 0.85) << "pattern " << static_cast<int>(p);
            EXPECT_LE(mean(image, c), 1.0);
        }
    }
}

TEST(PatternImages, onlyFoliageHasHoles) {
    for (std::size_t k = 0; k < patterns().size(); ++k) {
        const double opaque = mean(patterns()[k], 3);
        if (k == static_cast<std::size_t>(Pattern::foliage)) {
            EXPECT_GT(opaque, 0.3);
            EXPECT_LT(opaque, 0.9);
        } else {
            EXPECT_EQ(opaque, 1.0) << "pattern " << k;
        }
    }
}

TEST(PatternImages, facadesHaveDarkWindowsInTheMiddleAndWallAtTheEdge) {
    for (const Pattern p : {Pattern::facadePlaster, Pattern::facadeBrick, Pattern::facadeStone}) {
        const PatternImage& image = patterns()[static_cast<std::size_t>(p)];
        const int n = image.size;
        // A pane beside the middle bar; wall at the bay's edge at the same height.
        EXPECT_LT(texel(image, n * 44 / 100, n / 2, 1), 130);
        EXPECT_GT(texel(image, n * 10 / 100, n / 2, 1), 170);
    }
}

TEST(PatternImages, areTheSameEveryTime) {
    const auto again = city::paintPatterns();
    for (std::size_t k = 0; k < again.size(); ++k)
        EXPECT_EQ(again[k].rgba, patterns()[k].rgba) << "pattern " << k;
}
