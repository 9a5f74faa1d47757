#include "reflection/planar/ReflectionTree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "tests/reflection/planar/PaperScenes.h"

using namespace reflection;

namespace {

ReflectionTree treeOf(const CountedScene& s, CurvedMaps curved, const Economies& economies,
                      bool refresh = true) {
    TreeSettings settings;
    settings.depth = s.depth;
    settings.curved = curved;
    settings.economies = economies;
    settings.mapSize = {256, 256};
    settings.refreshCurved = refresh;
    settings.cutOff = 0;
    return reflectionTree(std::span(&s.view, 1), s.scene(), settings);
}

struct Row {
    CountedScene scene;
    std::uint32_t viewDependent, dynamicPlanar, staticPlanar, curved;
    double usedDependent, traditionalDependent, usedIndependent, traditionalIndependent;
};

std::vector<Row> tableOne() {
    return {{mirrorRoom(), 38, 62, 26, 1, 0.5, 1.8, 0.9, 1.9},
            {mirrorFloor(), 16, 19, 1, 3, 0.5, 1.0, 1.6, 1.4},
            {mirrorPair(), 16, 28, 4, 2, 0.5, 1.0, 1.3, 1.3},
            {mirrorCorner(), 46, 69, 15, 1, 0.8, 1.0, 1.1, 1.1}};
}

}  // namespace

TEST(ReflectionTree, CountsWhatTableOneOfThePaperCounts) {
    for (const Row& row : tableOne()) {
        const ReflectionTree dependent = treeOf(row.scene, CurvedMaps::viewDependent, Economies::paper());
        EXPECT_EQ(dependent.counters.generated(), row.viewDependent);
        const ReflectionTree dynamic = treeOf(row.scene, CurvedMaps::cube, Economies::paper());
        EXPECT_EQ(dynamic.counters.planar, row.dynamicPlanar);
        EXPECT_EQ(dynamic.counters.faces, 6 * row.curved);
        const ReflectionTree still = treeOf(row.scene, CurvedMaps::cube, Economies::paper(), false);
        EXPECT_EQ(still.counters.planar, row.staticPlanar);
        EXPECT_EQ(still.counters.faces, 0u);
    }
}

TEST(ReflectionTree, TextureMemoryIsTableOnes) {
    for (const Row& row : tableOne()) {
        TreeSettings s;
        s.depth = row.scene.depth;
        s.mapSize = {256, 256};
        const auto megabytes = [](std::uint64_t bytes) {
            return std::floor(10.0 * static_cast<double>(bytes) / (1 << 20) + 0.5) / 10;
        };
        s.curved = CurvedMaps::viewDependent;
        MapMemory m = paperMemory(s, row.scene.mirrors.size(), row.scene.curved.size());
        EXPECT_DOUBLE_EQ(megabytes(m.used), row.usedDependent);
        EXPECT_DOUBLE_EQ(megabytes(m.traditional), row.traditionalDependent);
        s.curved = CurvedMaps::cube;
        m = paperMemory(s, row.scene.mirrors.size(), row.scene.curved.size());
        EXPECT_DOUBLE_EQ(megabytes(m.used), row.usedIndependent);
        EXPECT_DOUBLE_EQ(megabytes(m.traditional), row.traditionalIndependent);
    }
}

TEST(ReflectionTree, EachLevelHasOneMapWhichIsFreeBeforeItIsUsedAgain) {
    for (const Row& row : tableOne()) {
        for (CurvedMaps curved : {CurvedMaps::viewDependent, CurvedMaps::cube, CurvedMaps::dualParaboloid}) {
            const ReflectionTree tree = treeOf(row.scene, curved, Economies::paper());
            EXPECT_LE(tree.levelSize.size(), static_cast<std::size_t>(row.scene.depth));
            std::vector<std::uint32_t> inMap(tree.levelSize.size(), ReflectionNode::none);
            std::set<std::uint32_t> applied;
            std::vector<ReflectionStep> steps = tree.environmentSteps();
            const auto main = tree.stepsOf(0);
            steps.insert(steps.end(), main.begin(), main.end());
            for (const ReflectionStep& s : steps) {
                if (s.what == ReflectionStep::What::draw) {
                    const std::uint32_t level = tree.nodes[s.node].level;
                    EXPECT_EQ(inMap[level], ReflectionNode::none);
                    inMap[level] = s.node;
                } else if (s.what == ReflectionStep::What::apply) {
                    const ReflectionNode& n = tree.nodes[s.node];
                    EXPECT_EQ(inMap[n.level], s.node);
                    inMap[n.level] = ReflectionNode::none;
                    if (n.parent != ReflectionNode::none) {
                        EXPECT_EQ(inMap[tree.nodes[n.parent].level], n.parent);
                        EXPECT_EQ(tree.nodes[n.parent].level + 1, n.level);
                    }
                    applied.insert(s.node);
                }
            }
            EXPECT_EQ(applied.size(), tree.nodes.size());
        }
    }
}

TEST(ReflectionTree, HidesACurvedReflectorFromItsOwnMapAloneAndShowsItBehindMirrors) {
    const CountedScene s = mirrorPair();
    const ReflectionTree dependent = treeOf(s, CurvedMaps::viewDependent, Economies::paper());
    for (const ReflectionNode& n : dependent.nodes)
        EXPECT_EQ(n.hiddenCurved, n.planar() ? ReflectionNode::none : n.curved);
    const ReflectionTree cube = treeOf(s, CurvedMaps::cube, Economies::paper());
    for (const ReflectionNode& n : cube.nodes) EXPECT_EQ(n.hiddenCurved, ReflectionNode::none);
    ASSERT_EQ(cube.environments.size(), 2u);
    // The second map finds the first one fresh and itself as it was.
    EXPECT_EQ(cube.environments[0].others, (std::vector<MapAge>{MapAge::lastFrame, MapAge::lastFrame}));
    EXPECT_EQ(cube.environments[1].others, (std::vector<MapAge>{MapAge::thisFrame, MapAge::lastFrame}));
}

TEST(ReflectionTree, CapKeepsTheMostVisibleAndTheirParents) {
    const CountedScene s = mirrorCorner();
    TreeSettings settings;
    settings.depth = 3;
    settings.cutOff = 0;
    const auto all = reflectionTree(std::span(&s.view, 1), s.scene(), settings);
    ASSERT_GT(all.nodes.size(), 8u);
    std::vector<double> pixels;
    for (const ReflectionNode& n : all.nodes) pixels.push_back(n.pixels);
    std::sort(pixels.rbegin(), pixels.rend());
    for (std::uint32_t cap = 1; cap < all.nodes.size(); ++cap) {
        settings.mostMaps = cap;
        const auto some = reflectionTree(std::span(&s.view, 1), s.scene(), settings);
        ASSERT_EQ(some.nodes.size(), cap);
        EXPECT_GT(some.counters.overCap, 0u);
        for (std::uint32_t i = 0; i < cap; ++i) {
            EXPECT_GE(some.nodes[i].pixels, pixels[cap - 1] - 1e-9);
            if (some.nodes[i].parent != ReflectionNode::none) {
                EXPECT_LT(some.nodes[i].parent, i);
            }
        }
    }
}

TEST(ReflectionTree, EndsWhereReflectancesMultiplyToNothing) {
    CountedScene s = mirrorPair();
    for (Mirror& m : s.mirrors) m.plane = MirrorPlane::make(m.plane.corners(), {glm::vec3(0.1f), 0}).mirror;
    TreeSettings settings;
    settings.depth = 8;
    settings.cutOff = 0.05;
    const auto one = reflectionTree(std::span(&s.view, 1), s.scene(), settings);
    EXPECT_EQ(one.counters.deepest, 1u);
    EXPECT_GT(one.counters.belowCutOff, 0u);
    settings.cutOff = 0.005;
    const auto two = reflectionTree(std::span(&s.view, 1), s.scene(), settings);
    EXPECT_EQ(two.counters.deepest, 2u);
}

TEST(ReflectionTree, CoplanarMirrorsShareOneView) {
    CountedScene s;
    for (int i = 0; i < 10; ++i) s.addMirror(square({2.5 * i - 11, 0, 1}, {0, -1, 0}, 1));
    EXPECT_EQ(groupCoplanar(s.mirrors), 1u);
    s.look({0, -20, 1.5}, {0, 0, 1});
    TreeSettings settings;
    const auto shared = reflectionTree(std::span(&s.view, 1), s.scene(), settings);
    ASSERT_EQ(shared.nodes.size(), 1u);
    EXPECT_EQ(shared.mirrorsOf(shared.nodes[0]).size() - 1, shared.counters.shared);
    settings.economies.share = false;
    const auto alone = reflectionTree(std::span(&s.view, 1), s.scene(), settings);
    EXPECT_EQ(alone.nodes.size(), shared.mirrorsOf(shared.nodes[0]).size());
    EXPECT_EQ(alone.nodes.size() + alone.counters.offScreen, 10u);
}

TEST(ReflectionTree, ListsNothingWhereNoMirrorIsInView) {
    CountedScene s = mirrorFloor();
    s.curved.clear();
    s.look({0, -6, 2}, {0, -12, 4});
    const auto tree = reflectionTree(std::span(&s.view, 1), s.scene(), TreeSettings{});
    EXPECT_TRUE(tree.empty());
    EXPECT_TRUE(tree.levelSize.empty());
    EXPECT_TRUE(tree.stepsOf(0).empty());
}

TEST(ReflectionTree, BoxesHideMirrorsOnlyWhereAllOfThemIsBehindOne) {
    CountedScene s;
    s.addMirror(square({0, 10, 0}, {0, -1, 0}, 1));
    s.look({0, 0, 0}, {0, 10, 0});
    ReflectionScene scene = s.scene();
    const auto count = [&](const city::Aabb& box) {
        scene.occluders = std::span(&box, 1);
        return reflectionTree(std::span(&s.view, 1), scene, TreeSettings{}).nodes.size();
    };
    const auto boxAt = [](glm::vec3 centre, glm::vec3 half) {
        city::Aabb b;
        b.min = centre - half;
        b.max = centre + half;
        return b;
    };
    EXPECT_EQ(count(boxAt({0, 5, 0}, {0.6f, 0.1f, 0.6f})), 0u);
    EXPECT_EQ(count(boxAt({0, 5, 0}, {0.4f, 0.1f, 0.6f})), 1u);
    EXPECT_EQ(count(boxAt({0, 11, 0}, {3, 0.5f, 3})), 1u);
    EXPECT_EQ(count(boxAt({0, -5, 0}, {3, 0.5f, 3})), 1u);
}

TEST(ReflectionTree, BadSettingsAreAStatus) {
    const CountedScene s = mirrorFloor();
    TreeSettings settings;
    settings.depth = -1;
    EXPECT_EQ(reflectionTree(std::span(&s.view, 1), s.scene(), settings).status, TreeStatus::badSettings);
    settings.depth = 2;
    settings.levelScale = std::nan("");
    EXPECT_EQ(reflectionTree(std::span(&s.view, 1), s.scene(), settings).status, TreeStatus::badSettings);
}
