#include "app/frame/MirrorPlan.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "app/frame/WetRoad.h"

namespace {

using app::MirrorPlan;
using app::MirrorPlanner;
using app::MirrorSettings;

/// A front 8 m wide and 2.6 m high with its left lower corner at `foot`, seen from its right-hand side.
city::GlassFront front(const glm::dvec3& foot, const glm::dvec3& along, float reflectance = 0.08f) {
    city::GlassFront f;
    f.normal = {along.y, -along.x, 0};
    f.outline = {foot, foot + 8.0 * along, foot + 8.0 * along + glm::dvec3(0, 0, 2.6),
                 foot + glm::dvec3(0, 0, 2.6)};
    for (const glm::dvec3& p : f.outline) f.bounds.extend(glm::vec3(p));
    f.paneCount = 8;
    f.area = 16;
    f.glass.reflectance = reflectance;
    return f;
}

constexpr glm::dvec3 east(1, 0, 0), west(-1, 0, 0);

/// A street of 14 m along x: the north side's fronts look south (y = 7), the south side's north (y = -7).
std::vector<city::GlassFront> street(int shopsASide) {
    std::vector<city::GlassFront> fronts;
    for (int i = 0; i < shopsASide; ++i) {
        fronts.push_back(front({10.0 * i, 7, 0.5}, east));
        fronts.push_back(front({10.0 * i + 8, -7, 0.5}, west));
    }
    return fronts;
}

app::View viewFrom(const glm::dvec3& eye, const glm::dvec3& target) {
    return app::lookAt(eye, target, 1.05, {1280, 720});
}

MirrorPlan planOf(const std::vector<city::GlassFront>& fronts, const app::View& view,
                  const MirrorSettings& settings = {}) {
    return MirrorPlanner(fronts).plan(std::span(&view, 1), settings);
}

TEST(MirrorPlan, CoplanarFrontsShareOneReflection) {
    // Down the street, one plane a side.
    const auto fronts = street(5);
    MirrorSettings settings;
    settings.depth = 1;
    const MirrorPlan plan = planOf(fronts, viewFrom({-10, 0, 2}, {40, 0, 2}), settings);
    EXPECT_EQ(plan.counters.inCity, 10u);
    EXPECT_EQ(plan.counters.passes, 2u);
    EXPECT_EQ(plan.counters.levels, 1u);
    EXPECT_GE(plan.counters.shown, 6u);
    EXPECT_EQ(plan.counters.windows, 8 * plan.counters.shown);
    EXPECT_EQ(plan.counters.shared, plan.counters.shown - 2);
    for (const auto& node : plan.tree.nodes) EXPECT_TRUE(node.view.mirrored());
}

/// Polished stone or frosted glass.
city::GlassFront roughFront(const glm::dvec3& foot, const glm::dvec3& along,
                            const city::GlassSurface& surface) {
    city::GlassFront f = front(foot, along);
    f.glass = surface;
    return f;
}

TEST(MirrorPlan, RoughFrontsHaveASmallViewOfTheirOwnAndPanesKeepTheirs) {
    const app::View view = viewFrom({4, 1, 1.7}, {5, 7, 1.5});
    std::vector<city::GlassFront> fronts{front({0, 7, 1.5}, east)};
    MirrorSettings settings;
    settings.depth = 1;
    const MirrorPlan clear = planOf(fronts, view, settings);
    ASSERT_EQ(clear.counters.passes, 1u);
    EXPECT_EQ(clear.counters.rough, 0u);
    // Both kinds in the plane of the panes.
    fronts.push_back(roughFront({0, 7, 0.2}, east, city::polishedGranite));
    fronts.push_back(roughFront({1, 7, 0.8}, east, city::frostedGlass));
    const MirrorPlan plan = planOf(fronts, view, settings);
    EXPECT_EQ(plan.counters.inCity, 3u);
    EXPECT_EQ(plan.counters.shown, 3u);
    EXPECT_EQ(plan.counters.rough, 2u);
    ASSERT_EQ(plan.counters.passes, 2u);  // one for the panes, one for both rough ones
    for (const auto& node : plan.tree.nodes) {
        const auto mirrors = plan.tree.mirrorsOf(node);
        if (node.roughness > 0) {
            EXPECT_EQ(mirrors.size(), 2u);
            EXPECT_EQ(node.roughness, city::frostedGlass.roughness);
            EXPECT_LE(node.resolution.x, static_cast<int>(app::roughTexels * view.size.x) + 1);
            EXPECT_LE(node.resolution.y, static_cast<int>(app::roughTexels * view.size.y) + 1);
        } else {
            ASSERT_EQ(mirrors.size(), 1u);
            EXPECT_EQ(plan.fronts[mirrors[0]], 0u);
            EXPECT_EQ(node.resolution, clear.tree.nodes[0].resolution);
        }
    }
}

TEST(MirrorPlan, SmallOrUnseenRoughFrontsAreDrawnWithoutAMap) {
    const std::vector<city::GlassFront> one{roughFront({0, 7, 0.5}, east, city::polishedGranite)};
    MirrorSettings settings;
    EXPECT_EQ(planOf(one, viewFrom({4, 1, 1.7}, {4, 7, 1.5}), settings).counters.rough, 1u);
    const app::View far = viewFrom({4, -60, 1.7}, {4, 7, 1.5});
    EXPECT_TRUE(planOf(one, far, settings).empty());
    settings.leastRoughPixels = settings.leastPixels;  // it is that setting which leaves it out
    EXPECT_EQ(planOf(one, far, settings).counters.rough, 1u);
    // Behind the eye, where a pane before it could show them.
    const std::vector<city::GlassFront> facing{front({0, 7, 0.5}, east),
                                               roughFront({8, -7, 0.5}, west, city::frostedGlass)};
    settings = {};
    settings.economies.cutOff = false;
    const app::View view = viewFrom({4, 2, 1.7}, {4, 7, 1.5});
    EXPECT_EQ(planOf(facing, view, settings).counters.passes, 1u);
    const std::vector<city::GlassFront> panes{front({0, 7, 0.5}, east), front({8, -7, 0.5}, west)};
    EXPECT_EQ(planOf(panes, view, settings).counters.passes, 2u);
}

TEST(MirrorPlan, RoughnessOfNoneAndAllIsPlannedAndWhatIsNoRoughnessRefused) {
    const app::View view = viewFrom({4, 1, 1.7}, {4, 7, 1.5});
    const auto withRoughness = [&](float roughness) {
        city::GlassSurface surface;
        surface.roughness = roughness;
        return planOf({roughFront({0, 7, 0.5}, east, surface)}, view);
    };
    EXPECT_EQ(withRoughness(0).counters.passes, 1u);
    EXPECT_EQ(withRoughness(0).counters.rough, 0u);
    const MirrorPlan matt = withRoughness(1);
    ASSERT_EQ(matt.counters.passes, 1u);
    EXPECT_EQ(matt.counters.rough, 1u);
    EXPECT_GE(matt.tree.nodes[0].resolution.x, 1);
    for (const float bad :
         {std::numeric_limits<float>::quiet_NaN(), -0.1f, 1.5f, std::numeric_limits<float>::infinity()}) {
        const MirrorPlan none = withRoughness(bad);
        EXPECT_TRUE(none.empty());
        EXPECT_EQ(none.counters.inCity, 0u);
    }
}

TEST(MirrorPlan, FacingFrontsAreMetAgainAtEveryDepth) {
    const auto fronts = street(3);
    const app::View view = viewFrom({5, -2, 2}, {5, 7, 1.8});
    for (int depth = 1; depth <= 3; ++depth) {
        MirrorSettings settings;
        settings.depth = depth;
        settings.economies.cutOff = false;
        settings.maps = 100;
        const MirrorPlan plan = planOf(fronts, view, settings);
        // One plane each time: north, south in north, north in that.
        EXPECT_EQ(plan.counters.passes, static_cast<std::uint32_t>(depth));
        EXPECT_EQ(plan.counters.levels, static_cast<std::uint32_t>(depth));
        // The front behind the camera is known to mirrors alone.
        EXPECT_LE(plan.counters.inView, 3u);
    }
}

TEST(MirrorPlan, NothingInViewCostsNothing) {
    const auto fronts = street(3);
    const app::View away = viewFrom({-20, 0, 2}, {-60, 0, 2});
    const MirrorPlan plan = planOf(fronts, away);
    EXPECT_TRUE(plan.empty());
    EXPECT_EQ(plan.counters.passes, 0u);
    EXPECT_EQ(plan.counters.texels, 0u);
    EXPECT_EQ(plan.tree.levelSize.size(), 0u);
    EXPECT_TRUE(planOf({}, away).empty());
}

TEST(MirrorPlan, SwitchedOffNothingIsPlanned) {
    const auto fronts = street(3);
    const app::View view = viewFrom({5, -2, 2}, {5, 7, 1.8});
    ASSERT_FALSE(planOf(fronts, view).empty());
    MirrorSettings off;
    off.on = false;
    EXPECT_TRUE(planOf(fronts, view, off).empty());
    off = {};
    off.depth = 0;
    EXPECT_TRUE(planOf(fronts, view, off).empty());
    off = {};
    off.maps = 0;
    EXPECT_TRUE(planOf(fronts, view, off).empty());
}

TEST(MirrorPlan, ExtremesOfTheEyeGiveNothingOrSomethingSound) {
    const std::vector<city::GlassFront> one{front({0, 7, 0.5}, east)};
    const double nan = std::numeric_limits<double>::quiet_NaN();
    // Behind, in the plane beside the pane, edge on, far, nowhere.
    EXPECT_TRUE(planOf(one, viewFrom({4, 12, 2}, {4, 7, 2})).empty());
    EXPECT_TRUE(planOf(one, viewFrom({-5, 7, 2}, {4, 7, 2})).empty());
    EXPECT_TRUE(planOf(one, viewFrom({4, 7, 1}, {4, 20, 2})).empty());
    EXPECT_TRUE(planOf(one, viewFrom({-5, 7 - 1e-6, 2}, {4, 7, 2})).empty());
    EXPECT_TRUE(planOf(one, viewFrom({4, -900, 2}, {4, 7, 2})).empty());
    EXPECT_TRUE(planOf(one, viewFrom({nan, 0, 2}, {4, 7, 2})).empty());
    // Nearer than the near plane the glass is not drawn.
    EXPECT_TRUE(planOf(one, viewFrom({4, 7 - 1e-3, 2}, {4, 7, 2})).empty());
    // A little before the glass: one reflection, everything in it finite.
    const MirrorPlan close = planOf(one, viewFrom({4, 7 - 0.11, 2}, {4, 7, 2}));
    ASSERT_EQ(close.counters.passes, 1u);
    const auto& node = close.tree.nodes[0];
    for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 4; ++r) EXPECT_TRUE(std::isfinite(node.obliqueClipFromView[c][r]));
}

TEST(MirrorPlan, CapLeavesOutTheLeastVisible) {
    // Two planes: a large near front, a small far one.
    const std::vector<city::GlassFront> two{front({20, 9, 0.5}, east), front({0, 7, 0.5}, east)};
    const app::View view = viewFrom({4, 0, 2}, {9, 8, 2});
    MirrorSettings settings;
    ASSERT_EQ(planOf(two, view, settings).counters.passes, 2u);
    settings.maps = 1;
    const MirrorPlan capped = planOf(two, view, settings);
    ASSERT_EQ(capped.counters.passes, 1u);
    EXPECT_EQ(capped.counters.overCap, 1u);
    EXPECT_EQ(capped.fronts[capped.tree.mirrors[0]], 1u);
}

TEST(MirrorPlan, WhatBuildingsHideIsLeftOut) {
    const auto fronts = street(1);
    const app::View view = viewFrom({4, -2, 2}, {4, 7, 1.8});
    int asked = 0, throughGlass = 0;
    const auto all = [&](const reflection::EyeView&, const reflection::HalfSpace* glass,
                         const city::Aabb& box) {
        ++asked;
        throughGlass += glass != nullptr ? 1 : 0;
        EXPECT_FALSE(box.empty());
        return true;
    };
    const MirrorPlan hidden = MirrorPlanner(fronts).plan(std::span(&view, 1), {}, all);
    EXPECT_TRUE(hidden.empty());
    EXPECT_EQ(hidden.counters.occluded, 1u);
    EXPECT_EQ(throughGlass, 0);
    const auto none = [&](const reflection::EyeView&, const reflection::HalfSpace* glass, const city::Aabb&) {
        throughGlass += glass != nullptr ? 1 : 0;
        return false;
    };
    EXPECT_EQ(MirrorPlanner(fronts).plan(std::span(&view, 1), {}, none).counters.passes, 2u);
    EXPECT_EQ(throughGlass, 1);
}

TEST(MirrorPlan, WetRoadIsOneLevelMirrorBelowTheEye) {
    const app::View view = viewFrom({0, 0, 2}, {30, 0, 0});
    MirrorSettings settings;
    settings.wetRoad = 0.25;
    const MirrorPlan plan = planOf({}, view, settings);
    ASSERT_EQ(plan.counters.passes, 1u);
    EXPECT_TRUE(plan.counters.road);
    EXPECT_EQ(plan.counters.shown, 0u);
    ASSERT_EQ(plan.fronts.size(), 1u);
    EXPECT_EQ(plan.fronts[0], MirrorPlan::road);
    EXPECT_NEAR(plan.tree.nodes[0].view.eye.z, -1.5, 1e-9);
    EXPECT_EQ(plan.tree.nodes[0].roughness, app::wetRoughness);
    EXPECT_LE(plan.tree.nodes[0].resolution.x, static_cast<int>(app::wetTexels * view.size.x) + 1);
    // From under the road, or far above all of it, there is nothing; nor where its height is unknown.
    EXPECT_TRUE(planOf({}, viewFrom({0, 0, 0.2}, {30, 0, 0}), settings).empty());
    EXPECT_TRUE(planOf({}, viewFrom({0, 0, 2}, {0, 0, 50}), settings).empty());
    settings.wetRoad = std::numeric_limits<double>::quiet_NaN();
    EXPECT_TRUE(planOf({}, view, settings).empty());
    // Windows are mirrored beside it; a shop's in it, and it in a shop's, are too dim.
    settings.wetRoad = 0;
    const MirrorPlan both = planOf(street(4), viewFrom({-10, 0, 2}, {20, 0, 1}), settings);
    EXPECT_TRUE(both.counters.road);
    EXPECT_GT(both.counters.shown, 2u);
    EXPECT_GE(both.counters.passes, 3u);
    EXPECT_GT(both.counters.belowCutOff, 0u);
}

TEST(WetRoad, HeightIsThatOfTheNearestLane) {
    city::RoadNetwork roads;
    EXPECT_FALSE(app::roadHeightNear(roads, {0, 0, 0}).has_value());
    city::Lane level, hill, tram;
    level.centreLine = {{0, 0, 1}, {100, 0, 1}};
    hill.centreLine = {{0, 20, 0}, {100, 20, 10}};
    tram.kind = city::LaneKind::tram;
    tram.centreLine = {{0, 3, 7}, {100, 3, 7}};
    roads.lanes = {level, hill, tram};
    EXPECT_DOUBLE_EQ(app::roadHeightNear(roads, {50, 4, 30}).value_or(-1), 1);
    EXPECT_NEAR(app::roadHeightNear(roads, {50, 19, 0}).value_or(-1), 5, 1e-6);
    EXPECT_NEAR(app::roadHeightNear(roads, {500, 40, 0}).value_or(-1), 10, 1e-6);
}

TEST(MirrorPlan, ADetailLimitsWhatIsAskedForAndAddsNothing) {
    const auto fronts = street(3);
    const app::View view = viewFrom({5, -2, 2}, {5, 7, 1.8});
    MirrorSettings asked;
    asked.depth = 3, asked.maps = 5;
    app::Detail detail;
    detail.mirrors = {1, 100, 100};
    MirrorSettings limited = asked;
    limited.limit(detail);
    EXPECT_EQ(limited, asked);

    detail.mirrors = {0.5, 1.4, 2};
    limited.limit(detail);
    EXPECT_EQ(limited.maps, 1u);
    EXPECT_EQ(limited.depth, 2);
    const MirrorPlan full = planOf(fronts, view, asked), less = planOf(fronts, view, limited);
    ASSERT_FALSE(full.tree.nodes.empty());
    ASSERT_FALSE(less.tree.nodes.empty());
    EXPECT_EQ(less.counters.passes, 1u);
    // It is what the eye sees most of, at half the side.
    const reflection::ReflectionNode& kept = less.tree.nodes.front();
    EXPECT_EQ(kept.parent, reflection::ReflectionNode::none);
    int widest = 0;
    for (const auto& node : full.tree.nodes)
        if (node.parent == reflection::ReflectionNode::none) widest = std::max(widest, node.resolution.x);
    EXPECT_NEAR(kept.resolution.x, 0.5 * widest, 2);

    detail.mirrors.maps = 0;
    limited.limit(detail);
    EXPECT_EQ(planOf(fronts, view, limited).counters.passes, 0u);
}

TEST(MirrorPlan, EqualInputGivesEqualPlans) {
    const auto fronts = street(6);
    const app::View view = viewFrom({-3, 1, 2}, {30, 4, 2});
    const MirrorPlan a = planOf(fronts, view), b = planOf(fronts, view);
    EXPECT_EQ(a.tree.mirrors, b.tree.mirrors);
    EXPECT_EQ(a.fronts, b.fronts);
    EXPECT_EQ(a.counters.texels, b.counters.texels);
}

}  // namespace
