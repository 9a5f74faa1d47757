// What is left out of a pane's image must be nothing that the pane looks up.
#include "app/render/PaneMask.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <random>
#include <vector>

#include "app/frame/MirrorPlan.h"

namespace {

using app::shownPart;

bool inside(const std::vector<glm::vec2>& polygon, const glm::dvec2& p) {
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const glm::dvec2 a(polygon[i]), b(polygon[(i + 1) % polygon.size()]);
        if ((b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x) < -1e-6) return false;
    }
    return !polygon.empty();
}

double areaOf(const std::vector<glm::vec2>& polygon) {
    double twice = 0;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const glm::dvec2 a(polygon[i]), b(polygon[(i + 1) % polygon.size()]);
        twice += a.x * b.y - b.x * a.y;
    }
    return 0.5 * twice;
}

reflection::ReflectionNode nodeOf(const glm::dvec3& eye, const glm::dvec3& target) {
    const app::View view = app::lookAt(eye, target, 1.05, {1280, 720});
    reflection::ReflectionNode node;
    node.view = app::eyeViewOf(view);
    node.clipFromView = node.view.clipFromView;
    node.resolution = view.size;
    return node;
}

std::array<glm::dvec3, 4> rectangle(const glm::dvec3& foot, const glm::dvec3& along, double height) {
    return {foot, foot + along, foot + along + glm::dvec3(0, 0, height), foot + glm::dvec3(0, 0, height)};
}

TEST(PaneMask, AllThatAPaneLooksUpIsShownAndLittleElse) {
    std::mt19937_64 random(7);
    const auto uniform = [&](double low, double high) {
        return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
    };
    constexpr double texels = 2;
    int looked = 0, tight = 0;
    for (int i = 0; i < 400; ++i) {
        const glm::dvec3 eye(uniform(-10, 10), uniform(-10, 10), uniform(1, 4));
        const auto node = nodeOf(eye, eye + glm::dvec3(uniform(-1, 1), uniform(-1, 1), uniform(-0.3, 0.3)));
        const auto outline = rectangle(eye + glm::dvec3(uniform(-30, 30), uniform(-30, 30), uniform(-3, 1)),
                                       glm::dvec3(uniform(-12, 12), uniform(-12, 12), 0), uniform(0.5, 4));
        const std::vector<glm::vec2> shown = shownPart(outline, node, texels);
        glm::dvec2 low(1e9), high(-1e9);
        bool whole = true;
        for (int k = 0; k < 60; ++k) {
            const double s = k < 4 ? (k == 1 || k == 2) : uniform(0, 1), t = k < 4 ? k / 2 : uniform(0, 1);
            const glm::dvec3 p = outline[0] + s * (outline[1] - outline[0]) + t * (outline[3] - outline[0]);
            const glm::dvec4 clip = node.clipFromView * glm::dvec4(node.view.viewFromWorld * (p - eye), 1);
            if (clip.w < 0.01) {
                whole = false;
                continue;
            }
            const glm::dvec2 at = glm::dvec2(clip) / clip.w;
            low = glm::min(low, at);
            high = glm::max(high, at);
            if (std::abs(at.x) > 1 || std::abs(at.y) > 1) {
                whole = false;
                continue;
            }
            // As far around as is promised, in the worst direction: a square's corner.
            for (const double x : {-1.0, 1.0})
                for (const double y : {-1.0, 1.0})
                    ASSERT_TRUE(inside(shown, at + 2 * texels * glm::dvec2(x, y) / glm::dvec2(1280, 720)));
            ++looked;
        }
        if (!whole || shown.empty()) continue;
        const glm::dvec2 border = 4 * texels / glm::dvec2(1280, 720);
        EXPECT_LE(areaOf(shown), (high.x - low.x + border.x) * (high.y - low.y + border.y) * (1 + 1e-5));
        ++tight;
    }
    EXPECT_GT(looked, 500);
    EXPECT_GT(tight, 10);
}

TEST(PaneMask, AFrontThatRunsAwayFromTheEyeShowsPartOfItsBounds) {
    const auto node = nodeOf({0, 0, 1.7}, {30, 0, 1.7});
    const auto shown = shownPart(rectangle({4, 3, 0.2}, {30, 0, 0}, 3), node, 2);
    glm::vec2 low(1e9f), high(-1e9f);
    for (const glm::vec2& p : shown) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    EXPECT_LT(areaOf(shown), 0.7 * (high.x - low.x) * (high.y - low.y));
    EXPECT_GT(areaOf(shown), 0.2 * (high.x - low.x) * (high.y - low.y));
}

TEST(PaneMask, BehindTheEyeFarOutOrNowhereIsNothing) {
    const auto node = nodeOf({0, 0, 1.7}, {30, 0, 1.7});
    EXPECT_TRUE(shownPart(rectangle({-5, -3, 0}, {0, 6, 0}, 3), node, 2).empty());
    EXPECT_TRUE(shownPart(rectangle({5, 300, 0}, {0, 6, 0}, 3), node, 2).empty());
    EXPECT_TRUE(shownPart(rectangle({std::numeric_limits<double>::quiet_NaN(), 0, 0}, {0, 6, 0}, 3), node, 2)
                    .empty());
    // Beside the eye and far beyond: what is before it stays, and is finite.
    const auto along = shownPart(rectangle({-50, 2, 0}, {100, 0, 0}, 3), node, 2);
    ASSERT_GE(along.size(), 3u);
    for (const glm::vec2& p : along) EXPECT_LT(glm::length(p), 2);
}

}  // namespace
