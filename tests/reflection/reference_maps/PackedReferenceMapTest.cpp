#include "reflection/reference_maps/PackedReferenceMap.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <stdexcept>

#include "reflection/reference_maps/CubeMapping.h"
#include "tests/reflection/tracing/SeededRandom.h"

namespace reflection {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float notANumber = std::numeric_limits<float>::quiet_NaN();

/// 7 mantissa bits, rounded to the nearest: half a step of 2^-7 where the mantissa is 1.
constexpr float nearnessError = 1.0f / 256 + 1e-6f;
/// 5 mantissa bits; the dither may move a value by up to a whole step of 2^-5.
constexpr float sumError = 1.0f / 32 + 1e-6f;
/// A share's rounding to 8 bits.
constexpr float shareError = 0.5f / 255 + 1e-6f;

ReferenceMap filled(int n, const glm::vec3& colour, float distance) {
    ReferenceMap map;
    map.faceSize = n;
    map.colour.assign(map.texelCount(), colour);
    map.distance.assign(map.texelCount(), distance);
    return map;
}

std::size_t texelIndex(int n, int face, int x, int y) {
    return (static_cast<std::size_t>(face) * static_cast<std::size_t>(n) + static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(n) +
           static_cast<std::size_t>(x);
}

float lengthAt(int face, int x, int y, int n) {
    return glm::length(cubeDirection(face, glm::vec2(x, y) + 0.5f, n));
}

TEST(PackedReferenceMapTest, distanceIsKeptWithinHalfAStep) {
    SeededRandom random(2);
    for (const int n : {4, 6, 10, 34, 64}) {
        ReferenceMap map = filled(n, glm::vec3(0.3f), 1);
        // Along the major axis 1/8 m to 8 km is what the eleven bits hold; the diagonal is up to sqrt 3
        // longer.
        for (float& d : map.distance) d = static_cast<float>(0.25 * std::exp2(random.between(0, 14.9)));
        const PackedReferenceMap packed(map, 8);
        const auto& level = packed.levels().front();
        for (int face = 0; face < 6; ++face)
            for (int y = 0; y < n; ++y)
                for (int x = 0; x < n; ++x) {
                    const float truth = map.distance[texelIndex(n, face, x, y)];
                    ASSERT_NEAR(truth * level.nearnessAt(face, x, y) / lengthAt(face, x, y, n), 1,
                                nearnessError);
                    ASSERT_NEAR(level.distanceAt(face, x, y) / truth, 1, 1.01f * nearnessError);
                }
    }
}

TEST(PackedReferenceMapTest, distancesOutsideTheRangeAreClamped) {
    struct Case {
        float distance, least, most;
    };
    const float nearest = 0.1255f;  // 1 / (4 (2 - 2^-7))
    for (const Case c :
         {Case{0, nearest * 0.99f, nearest * 1.8f}, Case{1e-30f, nearest * 0.99f, nearest * 1.8f},
          Case{infinity, infinity, infinity}, Case{notANumber, infinity, infinity},
          Case{-3, infinity, infinity}, Case{-0.0f, infinity, infinity}, Case{1e6f, infinity, infinity},
          Case{3e38f, infinity, infinity}}) {
        const PackedReferenceMap packed(filled(4, glm::vec3(1), c.distance), 8);
        for (int face = 0; face < 6; ++face)
            for (int y = -1; y <= 4; ++y)
                for (int x = -1; x <= 4; ++x) {
                    const float d = packed.levels().front().distanceAt(face, x, y);
                    ASSERT_GE(d, c.least) << c.distance;
                    // A border texel's direction is longer than any of the face's own.
                    ASSERT_LE(d, c.most * 1.3f) << c.distance;
                    ASSERT_GE(packed.levels().front().nearnessAt(face, x, y),
                              1 / PackedReferenceMap::skyDepth);
                }
    }
}

TEST(PackedReferenceMapTest, uniformColourIsKeptWithinItsBits) {
    SeededRandom random(3);
    for (int k = 0; k < 300; ++k) {
        const auto scale = static_cast<float>(std::exp2(random.between(-4, 8)));
        glm::vec3 c(random.unit(), random.unit(), random.unit());
        c *= scale * static_cast<float>(std::exp2(random.between(-12, 0))) / (c.r + c.g + c.b);
        const float sum = c.r + c.g + c.b;
        const PackedReferenceMap packed(filled(4, c, 5), scale);
        for (int i = 0; i < 16; ++i) {
            const glm::vec3 got = packed.levels().front().colourAt(i % 6, i % 4, i / 4);
            ASSERT_NEAR((got.r + got.g + got.b) / sum, 1, sumError + 1.0f / 255);
            for (int channel = 0; channel < 3; ++channel)
                ASSERT_NEAR(got[channel] / sum, c[channel] / sum,
                            2 * shareError + sumError * c[channel] / sum + 1e-4f);
        }
    }
}

TEST(PackedReferenceMapTest, ditherIsRightOnTheMean) {
    // 6 x 64 x 64 texels: the standard error of the mean is a step's half over 157, 1e-4; five of them.
    const float value = 0.77f;
    const PackedReferenceMap packed(filled(64, glm::vec3(value), 5), 8);
    double sum = 0;
    for (int face = 0; face < 6; ++face)
        for (int y = 0; y < 64; ++y)
            for (int x = 0; x < 64; ++x) {
                const glm::vec3 c = packed.levels().front().colourAt(face, x, y);
                sum += c.r + c.g + c.b;
            }
    EXPECT_NEAR(sum / (6 * 64 * 64) / (3 * value), 1, 5e-4);
}

TEST(PackedReferenceMapTest, coloursThatAreNoneAreBlackAndGreatOnesFinite) {
    const float scale = 8;
    for (const float bad : {0.0f, -1.0f, notANumber, -infinity, 1e-12f}) {
        const glm::vec3 c =
            PackedReferenceMap(filled(4, glm::vec3(bad), 5), scale).levels().front().colourAt(1, 2, 3);
        for (int channel = 0; channel < 3; ++channel) {
            ASSERT_GE(c[channel], 0) << bad;
            ASSERT_LE(c[channel], scale / 65536) << bad;
        }
    }
    for (const glm::vec3& great :
         {glm::vec3(1e4f), glm::vec3(3e38f), glm::vec3(infinity), glm::vec3(infinity, 0, infinity)}) {
        const PackedReferenceMap packed(filled(4, great, 5), scale);
        for (int i = 0; i < 16; ++i) {
            const glm::vec3 c = packed.levels().front().colourAt(0, i % 4, i / 4);
            for (int channel = 0; channel < 3; ++channel) {
                ASSERT_GE(c[channel], 0);
                ASSERT_LE(c[channel], scale);
                // Shares of equal channels are equal, whatever their size.
                const float parts = great.g > 0 ? 3 : 2;
                if (great[channel] > 0) {
                    ASSERT_NEAR(c[channel], scale / parts, scale * (1.0f / 32 + 1.0f / 128)) << great.r;
                }
            }
        }
    }
}

TEST(PackedReferenceMapTest, aBadTexelHarmsNoOther) {
    SeededRandom random(4);
    const int n = 8;
    ReferenceMap map = filled(n, glm::vec3(0.5f), 10);
    map.colour[texelIndex(n, 2, 3, 3)] = glm::vec3(notANumber, infinity, -infinity);
    map.distance[texelIndex(n, 2, 3, 3)] = notANumber;
    const PackedReferenceMap packed(map, 8);
    for (int face = 0; face < 6; ++face)
        for (int y = -1; y <= n; ++y)
            for (int x = -1; x <= n; ++x) {
                const glm::vec3 c = packed.levels().front().colourAt(face, x, y);
                ASSERT_TRUE(c.r >= 0 && c.g >= 0 && c.b >= 0 && c.r + c.g + c.b <= 8.1f);
                if (face == 2 && x == 3 && y == 3) continue;
                ASSERT_NEAR(c.r + c.g + c.b, 1.5f, 1.5f * (sumError + 1.0f / 255));
            }
}

TEST(PackedReferenceMapTest, bordersShowWhatLiesAcrossTheEdge) {
    SeededRandom random(5);
    for (const int n : {4, 8, 22}) {
        ReferenceMap map = filled(n, glm::vec3(0.5f), 1);
        for (float& d : map.distance) d = static_cast<float>(random.between(1, 100));
        const PackedReferenceMap packed(map, 8);
        const auto& level = packed.levels().front();
        for (int face = 0; face < 6; ++face)
            for (int y = -1; y <= n; ++y)
                for (int x = -1; x <= n; ++x) {
                    const bool outX = x < 0 || x >= n, outY = y < 0 || y >= n;
                    if (outX == outY) continue;
                    // The texel of the neighbour that is nearest in angle, by search.
                    const glm::vec3 d = glm::normalize(cubeDirection(face, glm::vec2(x, y) + 0.5f, n));
                    float best = -1, second = -1, truth = 0, other = 0;
                    for (int f = 0; f < 6; ++f)
                        for (int v = 0; v < n; ++v)
                            for (int u = 0; u < n; ++u) {
                                if (f == face) continue;
                                const float c =
                                    glm::dot(d, glm::normalize(cubeDirection(f, glm::vec2(u, v) + 0.5f, n)));
                                const float distance = map.distance[texelIndex(n, f, u, v)];
                                if (c > best) {
                                    second = best;
                                    other = truth;
                                    best = c;
                                    truth = distance;
                                } else if (c > second) {
                                    second = c;
                                    other = distance;
                                }
                            }
                    // One of the two nearest (halfway between them rounding decides).
                    const float got = level.distanceAt(face, x, y);
                    const float error = std::min(std::abs(got / truth - 1), std::abs(got / other - 1));
                    ASSERT_LT(error, 1.01f * nearnessError) << face << ' ' << x << ' ' << y;
                }
    }
}

TEST(PackedReferenceMapTest, levelsHalveDownToSixteen) {
    SeededRandom random(6);
    ReferenceMap map = filled(128, glm::vec3(0), 20);
    for (glm::vec3& c : map.colour)
        c = glm::vec3(random.between(0.2, 1), random.between(0.2, 1), random.between(0.2, 1));
    const PackedReferenceMap packed(map, 4);
    ASSERT_EQ(packed.levels().size(), 4u);
    for (std::size_t k = 0; k < 4; ++k) ASSERT_EQ(packed.levels()[k].faceSize(), 128 >> k);
    EXPECT_EQ(packed.levelFor(128).faceSize(), 128);
    EXPECT_EQ(packed.levelFor(64).faceSize(), 128);
    EXPECT_EQ(packed.levelFor(32).faceSize(), 64);
    EXPECT_EQ(packed.levelFor(16).faceSize(), 32);
    EXPECT_EQ(packed.levelFor(8).faceSize(), 16);
    EXPECT_EQ(packed.levelFor(1).faceSize(), 16);
    // A texel of the coarsest is the mean of its 8x8 (brightness; colour is shared by 4x2).
    for (int face = 0; face < 6; ++face)
        for (int y = 0; y < 16; ++y)
            for (int x = 0; x < 16; ++x) {
                double sum = 0;
                for (int k = 0; k < 64; ++k) {
                    const glm::vec3 c = map.colour[texelIndex(128, face, 8 * x + k % 8, 8 * y + k / 8)];
                    sum += c.r + c.g + c.b;
                }
                const glm::vec3 got = packed.levels()[3].colourAt(face, x, y);
                ASSERT_NEAR((got.r + got.g + got.b) / (sum / 64), 1, sumError + 1.0f / 255);
                ASSERT_NEAR(packed.levels()[3].distanceAt(face, x, y) / 20, 1, 1.01f * nearnessError);
            }
    EXPECT_EQ(PackedReferenceMap(filled(18, glm::vec3(1), 3), 4).levels().size(), 1u);
}

TEST(PackedReferenceMapTest, takesLessThanThreeBytesATexel) {
    const PackedReferenceMap packed(filled(256, glm::vec3(1), 3), 4);
    EXPECT_EQ(packed.texelCount(), 6u * (256 * 256 + 128 * 128 + 64 * 64 + 32 * 32 + 16 * 16));
    EXPECT_LT(static_cast<double>(packed.bytes()), 3.0 * static_cast<double>(packed.texelCount()));
}

TEST(PackedReferenceMapTest, refusesWhatItCannotHold) {
    for (const int n : {0, 1, 2, 3, 5, 7, 33})
        EXPECT_THROW(PackedReferenceMap(filled(n, glm::vec3(1), 1), 1), std::invalid_argument) << n;
    for (const float scale : {0.0f, -1.0f, notANumber, infinity})
        EXPECT_THROW(PackedReferenceMap(filled(4, glm::vec3(1), 1), scale), std::invalid_argument) << scale;
    ReferenceMap torn = filled(4, glm::vec3(1), 1);
    torn.distance.pop_back();
    EXPECT_THROW(PackedReferenceMap(torn, 1), std::invalid_argument);
}

TEST(ReferenceMapTest, representativeDistanceKeepsToTheMedianSurface) {
    std::vector<float> oneSurface{10, 12.5f, 10, 12.5f};
    EXPECT_NEAR(representativeDistance(oneSurface), 4 / (0.1f + 0.1f + 0.08f + 0.08f), 1e-4f);
    std::vector<float> post{2, 30, 30, 30};
    EXPECT_NEAR(representativeDistance(post), 30, 1e-4f);
    std::vector<float> sky{2, infinity, infinity, infinity};
    EXPECT_EQ(representativeDistance(sky), infinity);
    std::vector<float> roof{5, 5, infinity, infinity};
    EXPECT_NEAR(representativeDistance(roof), 5, 1e-5f);
    std::vector<float> touching{0, 0, 0};
    EXPECT_TRUE(std::isfinite(representativeDistance(touching)));
    std::vector<float> one{7};
    EXPECT_NEAR(representativeDistance(one), 7, 1e-5f);
}

}  // namespace
}  // namespace reflection
