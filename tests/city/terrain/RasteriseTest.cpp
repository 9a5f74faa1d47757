#include "city/terrain/Rasterise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace city {
namespace {

constexpr float nothing = -std::numeric_limits<float>::infinity();

/// splitmix64: the same numbers on every machine.
class Random {
  public:
    explicit Random(std::uint64_t seed) : state_(seed) {}
    double unit() {
        std::uint64_t z = (state_ += 0x9e3779b97f4a7c15ULL);
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
        return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
    }
    float between(double low, double high) { return static_cast<float>(low + (high - low) * unit()); }

  private:
    std::uint64_t state_;
};

void add(Mesh& mesh, glm::vec3 a, glm::vec3 b, glm::vec3 c) {
    mesh.addTriangle({a, {}, {}, 0}, {b, {}, {}, 0}, {c, {}, {}, 0});
}

void addRectangle(Mesh& mesh, float x0, float y0, float x1, float y1, float z) {
    add(mesh, {x0, y0, z}, {x1, y0, z}, {x1, y1, z});
    add(mesh, {x0, y0, z}, {x1, y1, z}, {x0, y1, z});
}

Mesh soup(Random& random, int triangles, double extent, double size) {
    Mesh mesh;
    for (int k = 0; k < triangles; ++k) {
        const glm::vec3 at(random.between(-2, extent + 2), random.between(-2, extent + 2),
                           random.between(0, 20));
        const auto corner = [&] {
            return at +
                   glm::vec3(random.between(-size, size), random.between(-size, size), random.between(-2, 2));
        };
        add(mesh, corner(), corner(), corner());
    }
    return mesh;
}

/// Barycentric coordinates of p in the triangle seen from above; false outside by more than `slack`.
bool heightAt(const Mesh& mesh, std::size_t triangle, glm::dvec2 p, double slack, double& z) {
    const glm::dvec3 a(mesh.vertices[mesh.indices[3 * triangle]].position);
    const glm::dvec3 b(mesh.vertices[mesh.indices[3 * triangle + 1]].position);
    const glm::dvec3 c(mesh.vertices[mesh.indices[3 * triangle + 2]].position);
    const double area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    if (area == 0) return false;
    const double v = ((p.x - a.x) * (c.y - a.y) - (p.y - a.y) * (c.x - a.x)) / area;
    const double w = ((b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x)) / area;
    if (v < -slack || w < -slack || v + w > 1 + slack) return false;
    z = a.z + v * (b.z - a.z) + w * (c.z - a.z);
    return true;
}

double highestAt(const Mesh& mesh, glm::dvec2 p, double slack) {
    double top = static_cast<double>(nothing), z = 0;
    for (std::size_t k = 0; k < mesh.triangleCount(); ++k)
        if (heightAt(mesh, k, p, slack, z)) top = std::max(top, z);
    return top;
}

TEST(RasteriseTest, centreAgreesWithPointInTriangleOracle) {
    Random random(1);
    for (int round = 0; round < 20; ++round) {
        Heightfield field(24, 20, 0.5f, {1.25, -3});
        Mesh mesh = soup(random, 40, 12, round % 2 == 0 ? 4 : 0.6);
        rasterise(mesh, glm::mat4(1), Coverage::centre, field);
        for (int j = 0; j < field.height(); ++j)
            for (int i = 0; i < field.width(); ++i) {
                const glm::dvec2 centre(1.25 + (i + 0.5) * 0.5, -3 + (j + 0.5) * 0.5);
                // Between the triangles shrunk and grown by a rounding error.
                const double low = highestAt(mesh, centre, -1e-9), high = highestAt(mesh, centre, 1e-9);
                EXPECT_GE(static_cast<double>(field.at(i, j)), low - 1e-4) << i << ' ' << j;
                EXPECT_LE(static_cast<double>(field.at(i, j)), high + 1e-4) << i << ' ' << j;
            }
    }
}

TEST(RasteriseTest, meshWithoutHolesLeavesNoCentreUncovered) {
    // A fan of slivers around one point that lies on a cell centre, and edges through rows of centres.
    Heightfield field(40, 40, 1, {0, 0});
    Mesh mesh;
    const glm::vec3 hub(20.5f, 20.5f, 3);
    Random random(2);
    std::vector<float> angles;
    for (int k = 0; k < 300; ++k) angles.push_back(random.between(0, 6.283185307));
    for (int k = 0; k < 8; ++k) angles.push_back(static_cast<float>(k) * 0.78539816f);
    std::sort(angles.begin(), angles.end());
    const auto rim = [&](float angle) {
        return hub + 60.0f * glm::vec3(std::cos(angle), std::sin(angle), 0);
    };
    for (std::size_t k = 0; k < angles.size(); ++k)
        add(mesh, hub, rim(angles[k]), rim(angles[(k + 1) % angles.size()]));
    rasterise(mesh, glm::mat4(1), Coverage::centre, field);
    for (float z : field.cells()) EXPECT_NEAR(z, 3, 1e-5);
}

TEST(RasteriseTest, anyCoversEveryCellThatATriangleTouches) {
    Random random(3);
    for (int round = 0; round < 10; ++round) {
        Heightfield field(16, 16, 1, {0, 0});
        Mesh mesh = soup(random, 6, 16, 3);
        rasterise(mesh, glm::mat4(1), Coverage::any, field);
        // Points strewn over each triangle: their cells are at least as high; and no cell is higher than the
        // triangles near it.
        for (std::size_t k = 0; k < mesh.triangleCount(); ++k)
            for (int n = 0; n < 4000; ++n) {
                double u = random.unit(), v = random.unit();
                if (u + v > 1) u = 1 - u, v = 1 - v;
                const glm::dvec3 a(mesh.vertices[3 * k].position), b(mesh.vertices[3 * k + 1].position),
                    c(mesh.vertices[3 * k + 2].position);
                const glm::dvec3 p = a + u * (b - a) + v * (c - a);
                if (p.x < 0 || p.y < 0 || p.x >= 16 || p.y >= 16) continue;
                ASSERT_GE(static_cast<double>(field.heightAt(p.x, p.y)), p.z - 1e-4);
            }
        for (int j = 0; j < 16; ++j)
            for (int i = 0; i < 16; ++i) {
                if (field.at(i, j) == nothing) continue;
                bool near = false;
                double z = 0;
                for (int n = 0; n < 40 * 40 && !near; ++n) {
                    const int column = n % 40, row = n / 40;
                    for (std::size_t k = 0; k < mesh.triangleCount() && !near; ++k)
                        near = heightAt(mesh, k, {i + (column + 0.5) / 40, j + (row + 0.5) / 40}, 0.05, z);
                }
                EXPECT_TRUE(near) << i << ' ' << j;
            }
    }
}

TEST(RasteriseTest, anyKeepsVerticalWallsAndCentreIgnoresThem) {
    Mesh wall;
    add(wall, {0.2f, 0.2f, 0}, {7.7f, 5.3f, 0}, {7.7f, 5.3f, 4});
    add(wall, {0.2f, 0.2f, 0}, {7.7f, 5.3f, 4}, {0.2f, 0.2f, 4});
    Heightfield centre(8, 8, 1, {0, 0}), any(8, 8, 1, {0, 0});
    rasterise(wall, glm::mat4(1), Coverage::centre, centre);
    rasterise(wall, glm::mat4(1), Coverage::any, any);
    EXPECT_EQ(centre.highest(), nothing);
    for (int n = 0; n <= 1000; ++n)
        EXPECT_NEAR(any.heightAt(0.2 + 7.5 * n / 1000, 0.2 + 5.1 * n / 1000), 4, 1e-5) << n;
    EXPECT_EQ(any.at(0, 5), nothing);
}

TEST(RasteriseTest, wholeIsNeverAboveTheMeshAnywhereInTheCell) {
    Random random(4);
    int covered = 0;
    for (int round = 0; round < 30; ++round) {
        Heightfield field(10, 10, 1, {0, 0});
        Mesh mesh = soup(random, 25, 10, 6);
        rasterise(mesh, glm::mat4(1), Coverage::whole, field);
        for (int j = 0; j < 10; ++j)
            for (int i = 0; i < 10; ++i) {
                if (field.at(i, j) == nothing) continue;
                ++covered;
                for (int n = 0; n < 100; ++n) {
                    const glm::dvec2 p(i + random.unit(), j + random.unit());
                    ASSERT_LE(static_cast<double>(field.at(i, j)), highestAt(mesh, p, 1e-7) + 1e-6)
                        << i << ' ' << j;
                }
            }
    }
    EXPECT_GT(covered, 300);
}

TEST(RasteriseTest, wholeFindsCellsCoveredBySeveralTrianglesTogether) {
    Heightfield field(6, 6, 1, {0, 0});
    Mesh roofs;
    addRectangle(roofs, 0.5f, 0.5f, 5.5f, 5.5f, 2);  // its diagonal crosses cells
    addRectangle(roofs, 1, 1, 2.5f, 5, 7);           // half of column 2
    addRectangle(roofs, 2.5f, 1, 4, 5, 6);           // the other half, lower
    rasterise(roofs, glm::mat4(1), Coverage::whole, field);
    EXPECT_EQ(field.at(0, 0), nothing) << "covered by a quarter";
    EXPECT_EQ(field.at(1, 2), 7);
    EXPECT_EQ(field.at(2, 2), 6);
    EXPECT_EQ(field.at(3, 3), 6);
    EXPECT_EQ(field.at(4, 4), 2);
}

TEST(RasteriseTest, raisesAndNeverLowersAndSkipsWhatIsNotFinite) {
    Heightfield field(4, 4, 1, {0, 0});
    field.set(1, 1, 9);
    field.set(2, 2, std::numeric_limits<float>::quiet_NaN());
    Mesh mesh;
    addRectangle(mesh, 0, 0, 4, 4, 5);
    add(mesh, {0, 0, std::numeric_limits<float>::quiet_NaN()}, {4, 0, 50}, {0, 4, 50});
    add(mesh, {-1e30f, 0, 1}, {1e30f, 1, 1}, {0, 1e30f, 1});
    mesh.indices.insert(mesh.indices.end(), {0, 1, 4000000});
    for (const Coverage coverage : {Coverage::centre, Coverage::any, Coverage::whole}) {
        Heightfield copy = field;
        rasterise(mesh, glm::mat4(1), coverage, copy);
        EXPECT_EQ(copy.at(1, 1), 9);
        EXPECT_EQ(copy.at(2, 2), 5);
        EXPECT_EQ(copy.at(0, 3), 5);
    }
}

TEST(RasteriseTest, transformPlacesTheMesh) {
    Mesh mesh;
    addRectangle(mesh, -1, -1, 1, 1, 2);
    glm::mat4 place(1);
    place[3] = glm::vec4(5, 6, 10, 1);
    Heightfield field(10, 10, 1, {0, 0});
    rasterise(mesh, place, Coverage::centre, field);
    int raised = 0;
    for (float z : field.cells()) raised += z == 12;
    EXPECT_EQ(raised, 4);
    EXPECT_EQ(field.at(4, 5), 12);
    EXPECT_EQ(field.at(5, 6), 12);
}

}  // namespace
}  // namespace city
