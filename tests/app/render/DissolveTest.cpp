// In which order a picture is replaced, and which parts at once: without OpenGL.
#include "app/render/Dissolve.h"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>
#include <vector>

#include "app/frame/View.h"
#include "app/render/ChangedParts.h"
#include "tests/reflection/tracing/SeededRandom.h"

namespace app {
namespace {

using reflection::SeededRandom;

struct Painted {
    glm::ivec2 size;
    std::vector<int> frame;  ///< in which a pixel was replaced first; -1: not yet

    explicit Painted(glm::ivec2 s) : size(s), frame(static_cast<std::size_t>(s.x * s.y), -1) {}
    std::size_t add(const glm::ivec4& r, int now) {
        std::size_t added = 0;
        for (int y = r.y; y < r.w; ++y)
            for (int x = r.x; x < r.z; ++x) {
                int& pixel = frame[static_cast<std::size_t>(y * size.x + x)];
                if (pixel >= 0) continue;
                pixel = now;
                ++added;
            }
        return added;
    }
};

TEST(DissolveTest, everyPixelHasItsTurnAndNoFrameMoreThanItsShare) {
    for (const glm::ivec2 size : {glm::ivec2(1, 1), glm::ivec2(640, 360), glm::ivec2(333, 77)})
        for (const int frames : {1, 7, 120, 5000}) {
            Dissolve dissolve;
            dissolve.start(size, frames);
            Painted painted(size);
            std::size_t most = 0;
            for (int frame = 0; frame < frames; ++frame) {
                ASSERT_TRUE(dissolve.active());
                std::size_t added = 0;
                for (const glm::ivec4& r : dissolve.advance()) {
                    ASSERT_GE(std::min(r.x, r.y), 0);
                    ASSERT_LE(r.z, size.x);
                    ASSERT_LE(r.w, size.y);
                    added += painted.add(r, frame);
                }
                most = std::max(most, added);
            }
            EXPECT_FALSE(dissolve.active());
            for (const int pixel : painted.frame) ASSERT_GE(pixel, 0);
            const auto tile = static_cast<std::size_t>(Dissolve::tile * Dissolve::tile);
            EXPECT_LE(most, painted.frame.size() / static_cast<std::size_t>(frames) + 2 * tile)
                << size.x << " x " << size.y << " in " << frames;
        }
}

TEST(DissolveTest, whatMovesIsLiveInEveryFrameWhereItIsAndWhereItWas) {
    Dissolve dissolve;
    dissolve.start({400, 300}, 1000);
    dissolve.keepLive(7, {10, 10, 20, 15});
    dissolve.keepLive(7, {15, 12, 30, 20});
    dissolve.keepLive(8, {-50, -50, 0, 400});  // outside
    dissolve.keepLive(9, {390, 290, 500, 500});
    for (int frame = 0; frame < 3; ++frame) {
        Painted painted({400, 300});
        for (const glm::ivec4& r : dissolve.advance()) painted.add(r, frame);
        for (int y = 10; y < 20; ++y)
            for (int x = 10; x < 30; ++x)
                ASSERT_EQ(painted.frame[static_cast<std::size_t>(y * 400 + x)], frame);
        EXPECT_EQ(painted.frame.back(), frame);
        EXPECT_LT(std::count(painted.frame.begin(), painted.frame.end(), frame), 20 * 10 + 10 * 10 + 300);
    }
    // Anew, while it goes on: what moved is part of the old picture, which must not change at once.
    dissolve.start({400, 300}, 1000);
    Painted painted({400, 300});
    for (const glm::ivec4& r : dissolve.advance()) painted.add(r, 1);
    EXPECT_EQ(painted.frame[12 * 400 + 12], -1);
}

TEST(DissolveTest, whatMovesChangesOverTileByTileAndIsLiveThen) {
    const glm::ivec2 size(640, 400);
    const glm::ivec4 box(37, 21, 517, 341);
    const std::size_t area = 480 * 320;
    for (const int frames : {2, 5, 24}) {
        Dissolve dissolve;
        dissolve.start(size, 1 << 20);
        std::vector<bool> before(static_cast<std::size_t>(size.x * size.y), false);
        std::size_t last = 0;
        for (int frame = 1; frame <= frames + 2; ++frame) {
            dissolve.keepLive(4, box, frame == 1 ? frames : 1);  // as when it was named first
            Painted now(size);
            for (const glm::ivec4& r : dissolve.advance()) {
                ASSERT_GE(std::min(r.x - box.x, r.y - box.y), 0);
                ASSERT_LE(std::max(r.z - box.z, r.w - box.w), 0);
                now.add(r, 0);
            }
            std::size_t count = 0;
            for (std::size_t i = 0; i < before.size(); ++i) {
                ASSERT_FALSE(before[i] && now.frame[i] < 0) << "live, then not";
                before[i] = now.frame[i] >= 0;
                count += before[i] ? 1 : 0;
            }
            const double share = std::min(1.0, static_cast<double>(frame) / frames);
            EXPECT_NEAR(static_cast<double>(count), share * static_cast<double>(area), 0.06 * area)
                << frame << " of " << frames;
            EXPECT_LE(count - last, area / static_cast<std::size_t>(frames) + area / 12);
            last = count;
        }
        EXPECT_EQ(last, area);
    }
}

TEST(ChangedPartsTest, aBoxesPixelsHoldAllOfIt) {
    SeededRandom random(5);
    const glm::ivec2 size(640, 360);
    const View view = lookAt({0, 0, 3}, {10, 2, 2}, 1.0, size);
    const glm::mat4 clip = view.clipFromView * view.viewFromWorld;
    int seen = 0, crossing = 0;
    for (int round = 0; round < 400; ++round) {
        city::Aabb box;
        const glm::vec3 centre(random.between(-8, 40), random.between(-15, 15), random.between(0, 4));
        const glm::vec3 half(random.between(0.2, 6), random.between(0.2, 4), random.between(0.2, 3));
        box.extend(centre - half);
        box.extend(centre + half);
        const auto pixels = pixelsOf(box, view.eye, clip, size);
        bool behind = false, before = false;
        for (int i = 0; i < 500; ++i) {
            const glm::vec3 point =
                box.min +
                glm::vec3(random.between(0, 1), random.between(0, 1), random.between(0, 1)) * box.size();
            const glm::vec4 at = clip * glm::vec4(point - glm::vec3(view.eye), 1);
            (at.w > 0.06f ? before : behind) = true;
            if (at.w <= 0.06f) continue;
            const glm::vec2 where = (glm::vec2(at) / at.w * 0.5f + 0.5f) * glm::vec2(size);
            if (where.x < 0 || where.y < 0 || where.x >= 640 || where.y >= 360) continue;
            ASSERT_TRUE(pixels) << round;
            ASSERT_GE(where.x, static_cast<float>(pixels->x)) << round;
            ASSERT_GE(where.y, static_cast<float>(pixels->y)) << round;
            ASSERT_LE(where.x, static_cast<float>(pixels->z)) << round;
            ASSERT_LE(where.y, static_cast<float>(pixels->w)) << round;
            ++seen;
        }
        crossing += behind && before ? 1 : 0;
        if (!before) {
            EXPECT_FALSE(pixels) << round;
        }
    }
    EXPECT_GT(seen, 1000);
    EXPECT_GT(crossing, 10);
}

TEST(ChangedPartsTest, tellsOfWhatMovesComesAndGoesAlone) {
    std::vector<vehicles::VehiclePose> poses(4);
    for (std::uint32_t i = 0; i < 4; ++i) {
        poses[i].id = 10 + i;
        poses[i].position = {20.0 * i, 0, 0};
    }
    MovingParts before{{poses.begin(), poses.end()},
                       {vehicles::SignalColour::red, vehicles::SignalColour::red}};
    const std::vector<city::SignalHead> heads(2);
    std::vector<std::uint64_t> told;
    const auto find = [&](const std::vector<vehicles::SignalColour>& colours) {
        told.clear();
        findChanges(
            before, poses, colours, heads, {0, 0.6f, 0.8f},
            [](const vehicles::VehiclePose& pose) {
                city::Aabb box;
                box.extend(glm::vec3(pose.position) - 1.f);
                box.extend(glm::vec3(pose.position) + 1.f);
                return box;
            },
            [](const auto& a, const auto& b) { return a.position != b.position; },
            [&](std::uint64_t name, const city::Aabb& box) {
                EXPECT_FALSE(box.empty());
                told.push_back(name);
            });
        std::sort(told.begin(), told.end());
        told.erase(std::unique(told.begin(), told.end()), told.end());
    };
    find(before.colours);
    EXPECT_TRUE(told.empty());
    std::swap(poses[0], poses[3]);  // another order
    find(before.colours);
    EXPECT_TRUE(told.empty());
    poses[1].position.x += 0.1;      // 11 moves
    poses.erase(poses.begin() + 2);  // 12 goes
    poses.emplace_back().id = 5;     // 5 comes
    find({vehicles::SignalColour::red, vehicles::SignalColour::green});
    EXPECT_EQ(told, (std::vector<std::uint64_t>{5, 11, 12, (std::uint64_t{1} << 32) + 1}));
}

}  // namespace
}  // namespace app
