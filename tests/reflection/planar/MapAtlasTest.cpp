// Images side by side: nothing is lost, nothing overlaps, nothing is larger than allowed.
#include "reflection/planar/MapAtlas.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "tests/reflection/planar/PaperScenes.h"

namespace reflection {
namespace {

ReflectionTree treeOf(const CountedScene& scene, bool resolution) {
    TreeSettings settings;
    settings.depth = 3;
    settings.curved = CurvedMaps::viewDependent;
    settings.economies = Economies::paper();
    settings.economies.resolution = resolution;
    settings.mapSize = {256, 256};
    settings.mostMaps = 1u << 20;
    return reflectionTree(std::span(&scene.view, 1), scene.scene(), settings);
}

bool overlap(const PixelRect& a, const PixelRect& b) {
    return a.low.x < b.high.x && b.low.x < a.high.x && a.low.y < b.high.y && b.low.y < a.high.y;
}

TEST(MapAtlas, EveryReflectionHasOnePlaceWhichNoOtherTouches) {
    CountedScene rough = mirrorCorner();
    for (Mirror& m : rough.mirrors)
        m.plane = MirrorPlane::make(m.plane.corners(), {glm::vec3(1), 0.2f}).mirror;
    for (const CountedScene& scene : {mirrorRoom(), mirrorFloor(), mirrorPair(), mirrorCorner(), rough})
        for (bool resolution : {false, true})
            for (int most : {4096, 1024, 300}) {
                const ReflectionTree tree = treeOf(scene, resolution);
                const ReflectionChildren children(tree);
                AtlasLimits limits;
                limits.most = glm::ivec2(most);
                std::multiset<std::uint32_t> tops, placed;
                for (const AtlasGroup& g : atlasGroups(tree, children, children.ofRoot[0], limits)) {
                    tops.insert(g.tops.begin(), g.tops.end());
                    if (!g.fits) {
                        EXPECT_EQ(g.tops.size(), 1u);
                        EXPECT_TRUE(g.levels.empty());
                        continue;
                    }
                    for (std::size_t k = 0; k < g.levels.size(); ++k) {
                        const AtlasGroup::Level& level = g.levels[k];
                        EXPECT_LE(std::max(level.size.x, level.size.y), most);
                        std::vector<PixelRect> rects;
                        for (const AtlasGroup::Place& p : level.places) {
                            const ReflectionNode& node = tree.nodes[p.node];
                            EXPECT_EQ(node.level, tree.nodes[g.tops.front()].level + k);
                            rects.push_back({p.origin, p.origin + node.resolution});
                            EXPECT_TRUE(glm::all(glm::lessThanEqual(rects.back().high, level.size)));
                            if (node.roughness > 0) {
                                EXPECT_EQ(p.origin % limits.roughAlignment, glm::ivec2(0));
                            }
                            placed.insert(p.node);
                        }
                        for (std::size_t i = 0; i < rects.size(); ++i)
                            for (std::size_t j = 0; j < i; ++j) EXPECT_FALSE(overlap(rects[i], rects[j]));
                    }
                }
                EXPECT_EQ(tops,
                          std::multiset<std::uint32_t>(children.ofRoot[0].begin(), children.ofRoot[0].end()));
                if (most == 4096) {
                    EXPECT_EQ(placed.size(), tree.nodes.size());
                }
                EXPECT_EQ(placed.size(), std::set<std::uint32_t>(placed.begin(), placed.end()).size());
            }
}

TEST(MapAtlas, WhatDoesNotFitIsDrawnByItself) {
    const ReflectionTree tree = treeOf(mirrorRoom(), false);
    const ReflectionChildren children(tree);
    AtlasLimits limits;
    limits.most = {255, 255};
    const auto groups = atlasGroups(tree, children, children.ofRoot[0], limits);
    EXPECT_EQ(groups.size(), children.ofRoot[0].size());
    for (const AtlasGroup& g : groups) EXPECT_FALSE(g.fits);
    EXPECT_TRUE(atlasGroups(tree, children, {}, limits).empty());
}

}  // namespace
}  // namespace reflection
