#include "reflection/reference_maps/CubeMapping.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <numbers>

#include "tests/reflection/tracing/SeededRandom.h"

namespace reflection {
namespace {

TEST(CubeMappingTest, axesAreOpenGlsTable) {
    // OpenGL 4.5 core, table 8.19: sc, tc, ma for a direction (rx, ry, rz).
    const glm::vec3 r(0.3f, -0.2f, 0.11f);
    const std::array<glm::vec2, 6> table{
        {{-r.z, -r.y}, {r.z, -r.y}, {r.x, r.z}, {r.x, -r.z}, {r.x, -r.y}, {-r.x, -r.y}}};
    for (std::size_t face = 0; face < 6; ++face) {
        EXPECT_EQ(glm::dot(cubeFaces[face].sAxis, r), table[face].x) << face;
        EXPECT_EQ(glm::dot(cubeFaces[face].tAxis, r), table[face].y) << face;
    }
}

TEST(CubeMappingTest, pointOfDirectionComesBackOnEveryFace) {
    SeededRandom random(1);
    for (int face = 0; face < 6; ++face) {
        for (int k = 0; k < 2000; ++k) {
            const int n = 1 + random.below(512);
            const glm::vec2 texel(random.between(1e-3, n - 1e-3), random.between(1e-3, n - 1e-3));
            const auto scale = static_cast<float>(std::exp(random.between(-20, 20)));
            const CubePoint p = cubePoint(cubeDirection(face, texel, n) * scale);
            // Two roundings of numbers up to 1, one division.
            const glm::vec2 st = texel * (2.0f / static_cast<float>(n)) - 1.0f;
            if (std::max(std::abs(st.x), std::abs(st.y)) < 1 - 1e-6f) {
                ASSERT_EQ(p.face, face);
                ASSERT_NEAR(p.st.x, st.x, 3e-7f);
                ASSERT_NEAR(p.st.y, st.y, 3e-7f);
            }
        }
    }
}

TEST(CubeMappingTest, edgesAndCornersBelongToTheFirstGreatestAxis) {
    for (int x = -1; x <= 1; ++x)
        for (int y = -1; y <= 1; ++y)
            for (int z = -1; z <= 1; ++z) {
                if (x == 0 && y == 0 && z == 0) continue;
                const CubePoint p = cubePoint({x, y, z});
                const int axis = x != 0 ? 0 : (y != 0 ? 1 : 2);
                const int value = axis == 0 ? x : (axis == 1 ? y : z);
                EXPECT_EQ(p.face, 2 * axis + (value < 0 ? 1 : 0)) << x << ' ' << y << ' ' << z;
                EXPECT_LE(std::max(std::abs(p.st.x), std::abs(p.st.y)), 1.0f);
                // The point of the face that is named lies in the direction again.
                const glm::vec3 back = cubeDirection(p.face, (p.st + 1.0f) * 0.5f, 1);
                EXPECT_EQ(back, glm::vec3(x, y, z));
            }
    EXPECT_EQ(cubePoint(glm::vec3(0)).face, 0);
}

TEST(CubeMappingTest, solidAnglesFillTheSphere) {
    double last = 1e9;
    for (const int n : {4, 16, 64, 256}) {
        double sum = 0;
        for (int y = 0; y < n; ++y)
            for (int x = 0; x < n; ++x)
                sum += 6 * static_cast<double>(texelSolidAngle(
                               (glm::vec2(x, y) + 0.5f) * (2.0f / static_cast<float>(n)) - 1.0f, n));
        const double error = std::abs(sum / (4 * std::numbers::pi) - 1);
        // The midpoint rule: second order in the texel's side; its constant here is below 1/2, floats add
        // 1e-6.
        EXPECT_LT(error, 0.5 / (n * n) + 2e-6) << n;
        EXPECT_LT(error, last);
        last = error;
    }
}

}  // namespace
}  // namespace reflection
