#include "reflection/chrome/ShownTriangles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <random>

namespace {

using reflection::VirtualVertex;

double side(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& p) {
    return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
}

// Whatever is left out must not hold the middle of any pixel, tried one by one.
TEST(ShownTriangles, leaveOutOnlyWhatCoversNoMiddleOfAPixel) {
    reflection::VirtualWindow window;
    window.size = {40, 30};
    window.pixels = {{4, 5}, {33, 22}};
    std::mt19937_64 random(7);
    const auto unit = [&] { return static_cast<float>(random() >> 40) / static_cast<float>(1 << 24); };
    std::vector<VirtualVertex> vertices;
    std::vector<std::uint32_t> triangles, shown;
    for (std::uint32_t t = 0; t < 3000; ++t) {
        const glm::vec2 middle(2.4f * unit() - 1.2f, 2.4f * unit() - 1.2f);
        const float wide = t % 3 == 0 ? 0.3f : 0.03f;
        for (std::uint32_t c = 0; c < 3; ++c) {
            const glm::vec3 at(middle.x + wide * (unit() - 0.5f), middle.y + wide * (unit() - 0.5f), 0.5f);
            vertices.push_back({at, reflection::ReflectionStatus::found});
            triangles.push_back(3 * t + c);
        }
    }
    reflection::showing(vertices, triangles, window, shown);
    std::size_t kept = 0, covering = 0;
    for (std::uint32_t t = 0; t < 3000; ++t) {
        const bool isKept = kept < shown.size() && shown[kept] == 3 * t;
        if (isKept) kept += 3;
        glm::dvec2 p[3];
        for (std::uint32_t c = 0; c < 3; ++c)
            p[c] = (glm::dvec2(vertices[3 * t + c].fromEye) * 0.5 + 0.5) * glm::dvec2(window.size);
        bool covers = false;
        for (int y = window.pixels.low.y; y < window.pixels.high.y; ++y)
            for (int x = window.pixels.low.x; x < window.pixels.high.x; ++x) {
                const glm::dvec2 q(x + 0.5, y + 0.5);
                const double a = side(p[0], p[1], q), b = side(p[1], p[2], q), c = side(p[2], p[0], q);
                covers = covers || (a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0);
            }
        covering += covers;
        EXPECT_TRUE(isKept || !covers) << t;
    }
    EXPECT_EQ(kept, shown.size());
    // And much of what covers none is left out.
    EXPECT_LT(shown.size() / 3, 2 * covering);
}

TEST(ShownTriangles, keepWhatReachesBehindTheEye) {
    reflection::VirtualWindow window;
    window.size = {8, 8};
    window.pixels = {{0, 0}, {8, 8}};
    window.clipFromVirtual[2][3] = 1;
    window.clipFromVirtual[3][3] = 0;
    const std::vector<VirtualVertex> vertices{{{50, 0, -1}, {}}, {{51, 0, 1}, {}}, {{50, 1, 1}, {}}};
    const std::vector<std::uint32_t> triangles{0, 1, 2};
    std::vector<std::uint32_t> shown;
    reflection::showing(vertices, triangles, window, shown);
    EXPECT_EQ(shown, triangles);
}

}  // namespace
