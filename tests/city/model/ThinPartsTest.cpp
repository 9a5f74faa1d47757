#include "city/model/CityHeightfield.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace city {
namespace {

void addRoof(Mesh& mesh, glm::vec2 a, glm::vec2 b, glm::vec2 c, glm::vec2 d, float z) {
    const auto corner = [&](glm::vec2 p) { return Vertex{{p.x, p.y, z}, {}, {}, 0}; };
    mesh.addQuad(corner(a), corner(b), corner(c), corner(d));
}

Chunk chunk(ChunkKind kind, Mesh mesh) {
    Chunk result{kind, std::move(mesh), {}};
    result.bounds = result.mesh.bounds();
    return result;
}

CityModel plain(float size) {
    CityModel city;
    Mesh ground;
    addRoof(ground, {0, 0}, {size, 0}, {size, size}, {0, size}, 0);
    city.chunks.push_back(chunk(ChunkKind::ground, ground));
    city.bounds.extend(glm::vec3(0));
    city.bounds.extend(glm::vec3(size, size, 20));
    return city;
}

void addBuilding(CityModel& city, glm::vec2 a, glm::vec2 b, glm::vec2 c, glm::vec2 d, float z) {
    Mesh roof;
    addRoof(roof, a, b, c, d, z);
    city.chunks.push_back(chunk(ChunkKind::building, roof));
}

TEST(ThinPartsTest, facadesStayWhereTheyAre) {
    CityModel city = plain(40);
    addBuilding(city, {10.4f, 10.4f}, {20.6f, 10.4f}, {20.6f, 20.6f}, {10.4f, 20.6f}, 12);
    const Heightfield field = cityHeightfield(city);
    for (int j = 0; j < 40; ++j)
        for (int i = 0; i < 40; ++i) {
            // Centres 10.5 ... 20.5 lie under the roof: not a cell more.
            const bool under = i >= 10 && i <= 20 && j >= 10 && j <= 20;
            EXPECT_EQ(field.heightAt(i + 0.5, j + 0.5), under ? 12.0f : 0.0f) << i << ' ' << j;
        }
}

TEST(ThinPartsTest, thinWallIsOneUnbrokenLineOfColumns) {
    CityModel city = plain(40);
    addBuilding(city, {5.2f, 5.1f}, {5.3f, 5.0f}, {31.3f, 20.0f}, {31.2f, 20.1f}, 4);  // 0.14 m thick, askew
    const Heightfield field = cityHeightfield(city);
    int raised = 0;
    for (int n = 0; n <= 2000; ++n) {
        const double s = n / 2000.0;
        EXPECT_EQ(field.heightAt(5.25 + 26 * s, 5.05 + 15 * s), 4) << s;
    }
    for (float z : field.cells()) raised += z == 4;
    EXPECT_LE(raised, 26 + 15 + 6) << "no wider than the cells that it passes through";
}

TEST(ThinPartsTest, crownsOfLeavesAreSolidAndPolesLeftOut) {
    CityModel city = plain(40);
    // Leaves with gaps of a cell between them.
    Prototype tree{"tree", {{Mesh(), 0}}, true};
    for (int v = -3; v <= 3; ++v)
        for (int u = -3; u <= 3; ++u)
            if ((u + v) % 2 == 0) {
                const glm::vec2 p(u, v);
                addRoof(tree.levels[0].mesh, p, p + glm::vec2(0.9f, 0), p + glm::vec2(0.9f),
                        p + glm::vec2(0, 0.9f), 6);
            }
    Prototype pole{"pole", {{Mesh(), 0}}, false};
    addRoof(pole.levels[0].mesh, {-2, -2}, {2, -2}, {2, 2}, {-2, 2}, 9);
    city.prototypes = {tree, pole};
    glm::mat4 at(1);
    at[3] = glm::vec4(12, 12, 0, 1);
    city.placements.push_back({0, at});
    at[3] = glm::vec4(30, 30, 0, 1);
    city.placements.push_back({1, at});
    const Heightfield field = cityHeightfield(city);
    for (int j = 10; j <= 14; ++j)
        for (int i = 10; i <= 14; ++i) EXPECT_EQ(field.heightAt(i + 0.5, j + 0.5), 6) << i << ' ' << j;
    EXPECT_EQ(field.heightAt(7.5, 12.5), 0) << "the crown does not grow";
    EXPECT_EQ(field.heightAt(30.5, 30.5), 0);
}

}  // namespace
}  // namespace city
