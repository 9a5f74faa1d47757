#include "reflection/local_map/LocalMapMesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "reflection/reference_maps/CubeMapping.h"
#include "tests/reflection/tracing/SeededRandom.h"

namespace reflection {
namespace {

city::Heightfield blocks(std::uint64_t seed) {
    SeededRandom random(seed);
    city::Heightfield field(80, 80, 1, {-40, -40});
    for (float& h : field.cells()) h = 0;
    for (int k = 0; k < 40; ++k) {
        const int x = random.below(74), y = random.below(74), w = 2 + random.below(5),
                  d = 2 + random.below(5);
        const auto height = static_cast<float>(random.between(1, 20));
        for (int j = y; j < y + d; ++j)
            for (int i = x; i < x + w; ++i)
                if (std::abs(i - 40) > 3 || std::abs(j - 40) > 3) field.set(i, j, height);
    }
    return field;
}

void expectTiling(const LocalMapMesh& mesh) {
    const int n = mesh.latticeSize();
    std::vector<int> covered(static_cast<std::size_t>(n) * static_cast<std::size_t>(n), 0);
    for (const auto& q : mesh.quads()) {
        ASSERT_GE(q.size, 1);
        ASSERT_LE(q.x + q.size, n);
        ASSERT_LE(q.y + q.size, n);
        for (int y = q.y; y < q.y + q.size; ++y)
            for (int x = q.x; x < q.x + q.size; ++x) ++covered[static_cast<std::size_t>(y * n + x)];
        for (const float w : q.corner) ASSERT_TRUE(w >= 0 && std::isfinite(w));
        ASSERT_TRUE(q.centre >= 0 && std::isfinite(q.centre));
    }
    for (const int c : covered) ASSERT_EQ(c, 1);
}

TEST(LocalMapMeshTest, quadsTileTheFaceOnce) {
    LocalMapMesh mesh;
    SeededRandom random(51);
    for (int k = 0; k < 60; ++k) {
        const GridTracer tracer(blocks(static_cast<std::uint64_t>(k)));
        MeshOptions options;
        options.baseCells = 1 + random.below(17);
        options.depth = random.below(5);
        options.criterion = random.below(2) ? RefineCriterion::planarity : RefineCriterion::depthRatio;
        options.threshold = static_cast<float>(random.between(0, 0.4));
        const glm::vec3 centre(random.between(-3, 3), random.between(-3, 3), random.between(0.5, 3));
        mesh.build(tracer, centre, k % 6, options);
        EXPECT_EQ(mesh.latticeSize(), options.baseCells << options.depth);
        expectTiling(mesh);
        if (HasFatalFailure()) return;
    }
}

TEST(LocalMapMeshTest, valuesAreTheTracersReciprocals) {
    const GridTracer tracer(blocks(3));
    const glm::vec3 centre(0.3f, -0.2f, 1.4f);
    LocalMapMesh mesh;
    for (int face = 0; face < 6; ++face) {
        mesh.build(tracer, centre, face, {});
        std::set<std::pair<float, float>> asked;
        const auto value = [&](float x, float y) {
            asked.emplace(x, y);
            const TraceResult hit = tracer.trace({centre, cubeDirection(face, {x, y}, mesh.latticeSize())});
            return hit.status == TraceStatus::hit ? 1 / std::max(hit.t, 1e-3f) : 0.0f;
        };
        for (const auto& q : mesh.quads()) {
            const float x = q.x, y = q.y, s = q.size;
            EXPECT_EQ(q.corner[0], value(x, y));
            EXPECT_EQ(q.corner[1], value(x + s, y));
            EXPECT_EQ(q.corner[2], value(x, y + s));
            EXPECT_EQ(q.corner[3], value(x + s, y + s));
            EXPECT_EQ(q.centre, value(x + s / 2, y + s / 2));
            // Those of the quads that were divided, up to the base.
            for (int size = q.size; size < 8; size *= 2) {
                const float parent = static_cast<float>(2 * size);
                const float px = std::floor(x / parent) * parent, py = std::floor(y / parent) * parent;
                for (const float u : {0.0f, parent})
                    for (const float v : {0.0f, parent}) asked.emplace(px + u, py + v);
                asked.emplace(px + parent / 2, py + parent / 2);
            }
        }
        EXPECT_EQ(mesh.raysTraced(), asked.size());
    }
}

/// The paper's section 4.4, written from its text: a quad whose corners' depths differ by more than R times
/// the smaller is divided into four.
struct PaperMesh {
    const GridTracer& tracer;
    glm::vec3 centre;
    int face;
    int lattice;
    float ratio;
    std::map<std::pair<int, int>, double> depth;
    std::set<std::tuple<int, int, int>> leaves;

    double depthAt(int x, int y) {
        const auto [it, isNew] = depth.try_emplace({x, y}, 0.0);
        if (isNew) {
            const TraceResult hit = tracer.trace({centre, cubeDirection(face, glm::vec2(x, y), lattice)});
            it->second = hit.status == TraceStatus::hit ? static_cast<double>(hit.t)
                                                        : std::numeric_limits<double>::infinity();
        }
        return it->second;
    }
    void divide(int x, int y, int size) {
        const double z[4] = {depthAt(x, y), depthAt(x + size, y), depthAt(x, y + size),
                             depthAt(x + size, y + size)};
        bool differ = false;
        for (const double a : z)
            for (const double b : z)
                if (a != b) differ = differ || std::abs(a - b) / std::min(a, b) > static_cast<double>(ratio);
        if (!differ || size == 1) {
            leaves.emplace(x, y, size);
            return;
        }
        const int half = size / 2;
        for (int k = 0; k < 4; ++k) divide(x + (k & 1) * half, y + (k >> 1) * half, half);
    }
};

TEST(LocalMapMeshTest, depthRatioIsThePapersRecursion) {
    LocalMapMesh mesh;
    SeededRandom random(52);
    for (int k = 0; k < 36; ++k) {
        const GridTracer tracer(blocks(100 + static_cast<std::uint64_t>(k)));
        MeshOptions options;
        options.baseCells = 10;
        options.depth = random.below(4);
        options.criterion = RefineCriterion::depthRatio;
        options.threshold = static_cast<float>(random.between(0.05, 0.5));
        const glm::vec3 centre(random.between(-3, 3), random.between(-3, 3), random.between(0.5, 3));
        mesh.build(tracer, centre, k % 6, options);
        PaperMesh paper{tracer, centre, k % 6, mesh.latticeSize(), options.threshold, {}, {}};
        const int size = 1 << options.depth;
        for (int y = 0; y < 10; ++y)
            for (int x = 0; x < 10; ++x) paper.divide(x * size, y * size, size);
        std::set<std::tuple<int, int, int>> leaves;
        for (const auto& q : mesh.quads()) {
            leaves.emplace(q.x, q.y, q.size);
            EXPECT_TRUE(q.smooth) << "the paper interpolates everywhere";
        }
        EXPECT_EQ(leaves, paper.leaves) << k;
        EXPECT_EQ(mesh.raysTraced(), paper.depth.size());
    }
}

TEST(LocalMapMeshTest, anEmptyPlainNeedsNoRefinement) {
    city::Heightfield plain(400, 400, 5, {-1000, -1000});
    for (float& h : plain.cells()) h = 0;
    const GridTracer tracer(plain);
    LocalMapMesh mesh;
    for (int face = 0; face < 6; ++face) {
        mesh.build(tracer, {0.7f, 0.2f, 1.5f}, face, {});
        EXPECT_EQ(mesh.quads().size(), 256u) << face;
        for (const auto& q : mesh.quads()) EXPECT_TRUE(q.smooth);
        EXPECT_EQ(mesh.raysTraced(), 17u * 17 + 16 * 16);
    }
}

TEST(LocalMapMeshTest, aStepIsRefinedAtItsEdgeAlone) {
    // From 10 m above: a roof at 3 m up to x = 3, behind its edge the ground. The edge lies at s = -3/7 of
    // face -Z (s = -x).
    city::Heightfield step(40, 40, 1, {-20, -20});
    for (int j = 0; j < 40; ++j)
        for (int i = 0; i < 40; ++i) step.set(i, j, i < 23 ? 3.0f : 0.0f);
    const GridTracer tracer(step);
    MeshOptions options;
    options.baseCells = 8;
    options.depth = 3;
    LocalMapMesh mesh;
    mesh.build(tracer, {0, 0, 10}, 5, options);
    const double edge = (1 - 3.0 / 7) * 32;
    int smallest = 0;
    for (const auto& q : mesh.quads()) {
        if (q.size == 1) ++smallest;
        if (q.x <= edge && edge <= q.x + q.size) {
            EXPECT_EQ(q.size, 1);
            EXPECT_FALSE(q.smooth) << "nothing lies between the roof and the ground";
        } else {
            EXPECT_TRUE(q.smooth);
        }
        if (q.size == 8) continue;
        const int parent = 2 * q.size, left = q.x / parent * parent;
        EXPECT_TRUE(left <= edge && edge <= left + parent) << q.x << ' ' << q.size;
    }
    EXPECT_EQ(smallest, 2 * 64);
    expectTiling(mesh);
}

TEST(LocalMapMeshTest, optionsOutOfRangeAreClamped) {
    const GridTracer tracer(blocks(5));
    LocalMapMesh mesh;
    MeshOptions options;
    options.baseCells = -3;
    options.depth = -1;
    mesh.build(tracer, {0, 0, 1}, 0, options);
    EXPECT_EQ(mesh.latticeSize(), 1);
    EXPECT_EQ(mesh.quads().size(), 1u);
    options.baseCells = 1;
    options.depth = 100;
    options.threshold = 10;
    mesh.build(tracer, {0, 0, 1}, 0, options);
    EXPECT_EQ(mesh.latticeSize(), 256);
    options.baseCells = 1'000'000;
    options.depth = 5;
    mesh.build(tracer, {0, 0, 1}, 0, options);
    EXPECT_EQ(mesh.latticeSize(), 4096);
    EXPECT_EQ(mesh.quads().size(), 128u * 128);
    // A centre inside a column: the reciprocal stays finite.
    city::Heightfield solid(4, 4, 1, {-2, -2});
    for (float& h : solid.cells()) h = 10;
    mesh.build(GridTracer(solid), {0.5f, 0.5f, 1}, 0, {});
    expectTiling(mesh);
    mesh.build(tracer, glm::vec3(std::numeric_limits<float>::quiet_NaN()), 0, {});
    expectTiling(mesh);
}

}  // namespace
}  // namespace reflection
