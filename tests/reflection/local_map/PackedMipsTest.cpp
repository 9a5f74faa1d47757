#include "reflection/local_map/PackedMips.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <cmath>
#include <limits>

#include "tests/reflection/tracing/SeededRandom.h"

namespace reflection {
namespace {

LocalMap randomMap(int n, std::uint64_t seed) {
    SeededRandom random(seed);
    LocalMap map;
    map.resize(n);
    for (auto* plane : {&map.red, &map.green, &map.blue})
        for (float& x : *plane) x = static_cast<float>(std::exp2(random.between(-6, 8)));
    for (float& x : map.depth) x = static_cast<float>(std::exp2(random.between(-4, 12)));
    return map;
}

/// Texel of a level by the definition: the mean of the texels of level 0 that it covers.
double boxMean(const std::vector<float>& plane, int n, int level, int face, int x, int y) {
    const int side = 1 << level;
    double sum = 0;
    for (int v = 0; v < side; ++v)
        for (int u = 0; u < side; ++u)
            sum += static_cast<double>(
                plane[static_cast<std::size_t>((face * n + y * side + v) * n + x * side + u)]);
    return sum / (side * side);
}

/// Half a step of 6 and of 5 mantissa bits where the mantissa is 1, and the means' rounding.
constexpr double error11 = 1.0 / 128 + 1e-5, error10 = 1.0 / 64 + 1e-5;

TEST(PackedMipsTest, everyLevelIsTheBoxFilter) {
    for (const int n : {1, 2, 4, 8, 32, 64}) {
        const LocalMap map = randomMap(n, static_cast<std::uint64_t>(n));
        PackedMips mips;
        packMips(map, mips);
        ASSERT_EQ(1 << (mips.levelCount() - 1), n);
        ASSERT_EQ(mips.texels.size(), mips.levelOffset(mips.levelCount()));
        for (int level = 0; level < mips.levelCount(); ++level) {
            const int side = n >> level;
            for (int face = 0; face < 6; ++face)
                for (int y = 0; y < side; ++y)
                    for (int x = 0; x < side; ++x) {
                        float r, g, b;
                        unpackTexel(mips.texels[mips.levelOffset(level) +
                                                static_cast<std::size_t>((face * side + y) * side + x)],
                                    r, g, b);
                        ASSERT_NEAR(r / boxMean(map.red, n, level, face, x, y), 1, error11)
                            << n << ' ' << level;
                        ASSERT_NEAR(g / boxMean(map.green, n, level, face, x, y), 1, error11);
                        ASSERT_NEAR(b / boxMean(map.blue, n, level, face, x, y), 1, error10);
                    }
        }
    }
}

TEST(PackedMipsTest, roundsToTheNearestOfAllSmallFloats) {
    // Every code comes back as itself, and what lies between two goes to the nearer.
    LocalMap map;
    map.resize(32);
    for (std::uint32_t code = 1u << 6; code < 31u << 6; ++code) {
        float r, g, b, next, unused;
        unpackTexel(code | (code << 11), r, g, b);
        ASSERT_EQ(r, g);
        ASSERT_TRUE(std::isfinite(r));
        unpackTexel(code + 1, next, unused, unused);
        const std::size_t i = code % map.red.size();
        map.red[i] = r;
        map.green[i] = code + 1 < 31u << 6 ? r + 0.49f * (next - r) : r;
        PackedMips mips;
        if (code % 64 != 0) continue;
        packMips(map, mips);
        EXPECT_EQ(mips.texels[i] & 0x7ff, code);
        EXPECT_EQ((mips.texels[i] >> 11) & 0x7ff, code);
    }
}

TEST(PackedMipsTest, clampsWhatDoesNotFit) {
    const float nan = std::numeric_limits<float>::quiet_NaN(),
                infinity = std::numeric_limits<float>::infinity();
    LocalMap map;
    map.resize(3);
    const std::vector<float> bad{0, -0.0f, -1, nan, -nan, -infinity, 1e-9f, 6e-5f};
    const std::vector<float> great{65024, 66000, 1e10f, infinity, 3e38f};
    for (std::size_t i = 0; i < map.red.size(); ++i)
        map.red[i] = map.green[i] = map.blue[i] = bad[i % bad.size()];
    PackedMips mips;
    packMips(map, mips);
    EXPECT_EQ(mips.levelCount(), 1);
    ASSERT_EQ(mips.texels.size(), 54u);
    for (std::uint32_t t : mips.texels) EXPECT_EQ(t, 0u);
    for (std::size_t i = 0; i < map.red.size(); ++i)
        map.red[i] = map.green[i] = map.blue[i] = great[i % great.size()];
    packMips(map, mips);
    for (std::uint32_t t : mips.texels) {
        float r, g, b;
        unpackTexel(t, r, g, b);
        EXPECT_EQ(r, 65024.0f);
        EXPECT_EQ(g, 65024.0f);
        EXPECT_EQ(b, 64512.0f);
    }
}

TEST(PackedMipsTest, nearnessIsOneOverDepthToHalfAStepAndZeroForTheSky) {
    const float nan = std::numeric_limits<float>::quiet_NaN(),
                infinity = std::numeric_limits<float>::infinity();
    for (const int n : {1, 7, 32}) {
        LocalMap map = randomMap(n, 5);
        SeededRandom random(3);
        for (float& d : map.depth) d = static_cast<float>(std::exp2(random.between(-15, 13.9)));
        map.depth[0] = infinity;
        map.depth[1] = nan;
        map.depth[2] = 20000;
        map.depth[3] = 0;
        PackedMips mips;
        packMips(map, mips);
        ASSERT_EQ(mips.nearness.size(), map.depth.size());
        for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(mips.nearness[i], 0) << i;
        EXPECT_EQ(unpackNearness(mips.nearness[3]), 65504.0f);
        // Half a step of 10 mantissa bits where the mantissa is 1, and the quotient's rounding.
        for (std::size_t i = 4; i < map.depth.size(); ++i)
            ASSERT_NEAR(unpackNearness(mips.nearness[i]) * map.depth[i], 1, 1.0 / 2048 + 1e-6)
                << map.depth[i];
    }
}

TEST(PackedMipsTest, isTheSameOnEveryInstructionSet) {
    const std::int64_t all = hwy::SupportedTargets();
    for (const int n : {1, 7, 16, 32}) {
        const LocalMap map = randomMap(n, 77);
        PackedMips best, mips;
        packMips(map, best);
        for (int bit = 0; bit < 63; ++bit) {
            const std::int64_t target = std::int64_t{1} << bit;
            if ((all & target) == 0) continue;
            hwy::SetSupportedTargetsForTest(target);
            hwy::GetChosenTarget().Update(hwy::SupportedTargets());
            packMips(map, mips);
            EXPECT_EQ(mips.texels.size(), best.texels.size());
            EXPECT_EQ(mips.nearness, best.nearness) << hwy::TargetName(target);
            // Sums of four are taken in another order by the remainder's loop: the last bit of a mean may
            // round to another code.
            std::size_t differ = 0;
            for (std::size_t i = 0; i < best.texels.size(); ++i)
                differ += mips.texels[i] != best.texels[i] ? 1 : 0;
            EXPECT_LE(differ, best.texels.size() / 500) << hwy::TargetName(target);
        }
        hwy::SetSupportedTargetsForTest(0);
        hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    }
}

}  // namespace
}  // namespace reflection
