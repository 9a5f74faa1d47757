#include "city/model/GlassFronts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "city/generate/Boulevard.h"
#include "city/generate/PaperCity.h"
#include "city/model/PatternImages.h"

namespace {

using city::GlassFront;
using city::GlassFronts;
using city::Pattern;

city::CityModel wall(Pattern pattern, glm::vec2 a, glm::vec2 b, float z0, float z1, glm::vec2 repeats,
                     float lean = 0) {
    city::CityModel city;
    city.materials.resize(3);
    city.materials[2].pattern = pattern;
    city::Chunk chunk;
    const glm::vec3 along(glm::normalize(b - a), 0);
    const glm::vec3 n(along.y, -along.x, 0);
    const glm::vec3 top(glm::vec2(-n) * lean, 0);
    chunk.mesh.addQuad({{a, z0}, n, {0, 0}, 2}, {{b, z0}, n, {repeats.x, 0}, 2},
                       {glm::vec3(b, z1) + top, n, repeats, 2},
                       {glm::vec3(a, z1) + top, n, {0, repeats.y}, 2});
    city.chunks.push_back(chunk);
    return city;
}

double areaOf(const city::Mesh& mesh) {
    double sum = 0;
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        const glm::dvec3 a(mesh.vertices[mesh.indices[i]].position),
            b(mesh.vertices[mesh.indices[i + 1]].position), c(mesh.vertices[mesh.indices[i + 2]].position);
        sum += 0.5 * glm::length(glm::cross(b - a, c - a));
    }
    return sum;
}

TEST(GlassFronts, ShopOfThreeBaysHasTwelvePanesInOnePlane) {
    const auto found = city::glassFronts(wall(Pattern::shopFront, {10, 5}, {22, 5}, 0.2f, 4.2f, {3, 1}));
    ASSERT_EQ(found.fronts.size(), 1u);
    const GlassFront& front = found.fronts[0];
    EXPECT_EQ(front.paneCount, 12u);
    EXPECT_NEAR(glm::length(front.normal - glm::dvec3(0, -1, 0)), 0, 1e-9);
    // Each bay is 4 m square: its panes' share of the picture.
    const double share = 0.27 * 0.65 + 0.255 * 0.65 + 0.2 * 0.47 + 0.2 * 0.13;
    EXPECT_NEAR(front.area, 3 * 16 * share, 1e-4);
    EXPECT_NEAR(areaOf(front.panes), front.area, 1e-3);
    for (const auto& v : front.panes.vertices) {
        EXPECT_NEAR(v.position.y, 5 - city::paneOffset, 1e-5);
        EXPECT_EQ(v.material, 2u);
    }
    // The outline holds all panes and no more, and is seen counter-clockwise from the street.
    EXPECT_NEAR(front.outline[0].x, 10 + 4 * 0.065, 1e-5);
    EXPECT_NEAR(front.outline[2].x, 10 + 4 * 2.9, 1e-5);
    EXPECT_NEAR(front.outline[0].z, 0.2 + 4 * 0.115, 1e-5);
    EXPECT_NEAR(front.outline[2].z, 0.2 + 4 * 0.765, 1e-5);
    const glm::dvec3 turn =
        glm::cross(front.outline[1] - front.outline[0], front.outline[2] - front.outline[1]);
    EXPECT_GT(glm::dot(turn, front.normal), 0);
    EXPECT_EQ(found.census.planes, 1u);
}

TEST(GlassFronts, PanesFaceTheStreetAndKeepTheWallsTexture) {
    const auto found = city::glassFronts(wall(Pattern::facadeGlass, {0, 0}, {-3, 4}, 0, 9, {2, 3}));
    ASSERT_EQ(found.fronts.size(), 1u);
    const GlassFront& front = found.fronts[0];
    EXPECT_EQ(front.paneCount, 24u);
    for (std::size_t i = 0; i < front.panes.indices.size(); i += 3) {
        const auto& a = front.panes.vertices[front.panes.indices[i]];
        const auto& b = front.panes.vertices[front.panes.indices[i + 1]];
        const auto& c = front.panes.vertices[front.panes.indices[i + 2]];
        EXPECT_GT(
            glm::dot(glm::dvec3(glm::cross(b.position - a.position, c.position - a.position)), front.normal),
            0);
        // Height follows the texture: three storeys of 3 m.
        EXPECT_NEAR(a.position.z, 3 * a.texcoord.y, 1e-4);
    }
}

TEST(GlassFronts, CutBaysKeepWhatIsLeftOfTheirPanes) {
    // Half a bay: the first window, not the door.
    const auto found = city::glassFronts(wall(Pattern::shopFront, {0, 0}, {2, 0}, 0, 4, {0.5f, 1}));
    ASSERT_EQ(found.fronts.size(), 1u);
    EXPECT_NEAR(found.fronts[0].area, 16 * (0.27 * 0.65 + 0.15 * 0.65), 1e-4);
}

TEST(GlassFronts, TrianglesGiveTheSameGlassAsQuads) {
    city::CityModel quads = wall(Pattern::shopFront, {0, 0}, {12, 0}, 0, 4, {3, 1});
    city::CityModel triangles = quads;
    const city::Mesh& m = quads.chunks[0].mesh;
    city::Mesh& t = triangles.chunks[0].mesh;
    t = {};
    t.addTriangle(m.vertices[0], m.vertices[1], m.vertices[2]);
    t.addTriangle(m.vertices[0], m.vertices[2], m.vertices[3]);
    const auto a = city::glassFronts(quads), b = city::glassFronts(triangles);
    EXPECT_NEAR(a.census.area, b.census.area, 0.2);  // slivers on the diagonal are left out
    EXPECT_EQ(b.census.planes, 1u);
}

TEST(GlassFronts, LeavesOutWhatIsNoMirror) {
    EXPECT_EQ(city::glassFronts(wall(Pattern::facadePlaster, {0, 0}, {12, 0}, 0, 12, {4, 4})).census.painted,
              1u);
    EXPECT_EQ(city::glassFronts(wall(Pattern::shopFront, {0, 0}, {1, 0}, 0, 1, {1, 1})).census.tooSmall, 1u);
    EXPECT_EQ(city::glassFronts(wall(Pattern::shopFront, {0, 0}, {12, 0}, 0, 4, {3, 1}, 1)).census.notUpright,
              1u);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    for (const glm::vec2 repeats : {glm::vec2(0, 0), glm::vec2(nan, 1), glm::vec2(1e9f, 1)})
        EXPECT_TRUE(
            city::glassFronts(wall(Pattern::shopFront, {0, 0}, {12, 0}, 0, 4, repeats)).fronts.empty());
    EXPECT_TRUE(city::glassFronts(wall(Pattern::shopFront, {0, 0}, {nan, 0}, 0, 4, {3, 1})).fronts.empty());
    EXPECT_TRUE(city::glassFronts({}).fronts.empty());
}

TEST(GlassFronts, PanesLieOnTheGlassOfThePictures) {
    // Along each pane's border the picture is darker inside than outside: there is the frame.
    const auto images = city::paintPatterns();
    for (const Pattern pattern : {Pattern::shopFront, Pattern::facadeGlass}) {
        const auto& image = images[static_cast<std::size_t>(pattern)];
        const auto grey = [&](double u, double v) {
            const auto at = [&](double x) {
                return static_cast<std::size_t>(
                    std::clamp(static_cast<int>(x * image.size), 0, image.size - 1));
            };
            const std::size_t texel = (at(v) * static_cast<std::size_t>(image.size) + at(u)) * 4;
            return (image.rgba[texel] + image.rgba[texel + 1] + image.rgba[texel + 2]) / 3.0;
        };
        const double step = 2.5 / image.size;
        for (const city::PaneOfPattern& pane : city::panesOf(pattern)) {
            const double middle = 0.5 * (pane.low.y + pane.high.y);
            // Goods stand in the way elsewhere: compared halfway up.
            const double inside = grey(pane.low.x + step, middle), outside = grey(pane.low.x - step, middle);
            EXPECT_LT(inside + 20, outside) << "pane at " << pane.low.x << ", " << pane.low.y;
        }
    }
}

TEST(GlassFronts, BoulevardHasShopsAndFewPlanes) {
    const city::CityModel boulevard = city::generateBoulevard({});
    const GlassFronts found = city::glassFronts(boulevard);
    EXPECT_GT(found.census.shopFronts, 50u);
    EXPECT_GT(found.census.panes, 4 * found.census.shopFronts);
    EXPECT_LT(found.census.planes, found.fronts.size());
    for (const GlassFront& front : found.fronts) {
        EXPECT_NEAR(glm::length(front.normal), 1, 1e-12);
        EXPECT_GE(front.area, city::leastGlass);
        for (const glm::dvec3& p : front.outline)
            EXPECT_NEAR(glm::dot(front.normal, p - front.outline[0]), 0, 1e-5);
    }
    // Found again exactly.
    const GlassFronts again = city::glassFronts(boulevard);
    ASSERT_EQ(again.fronts.size(), found.fronts.size());
    EXPECT_EQ(again.census.area, found.census.area);
    RecordProperty("fronts", static_cast<int>(found.fronts.size()));
    RecordProperty("planes", static_cast<int>(found.census.planes));
}

}  // namespace
