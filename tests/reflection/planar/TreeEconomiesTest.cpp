// What each economy leaves out, and that it is no more: found by changing the tree's builder in single places
// and looking which changes no test saw.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "reflection/planar/Gloss.h"
#include "reflection/planar/MirrorView.h"
#include "tests/reflection/planar/PaperScenes.h"

namespace reflection {
namespace {

ReflectionTree treeOf(const CountedScene& s, const TreeSettings& settings) {
    return reflectionTree(std::span(&s.view, 1), s.scene(), settings);
}

TreeSettings settingsFor(int depth, CurvedMaps curved = CurvedMaps::none) {
    TreeSettings settings;
    settings.depth = depth;
    settings.curved = curved;
    settings.cutOff = 0;
    settings.mostMaps = 1u << 20;
    return settings;
}

void roughen(CountedScene& s, float roughness) {
    for (Mirror& m : s.mirrors)
        m.plane = MirrorPlane::make(m.plane.corners(), {m.plane.surface().reflectance, roughness}).mirror;
}

// A level mirror of two metres, five metres in front of the eye: the projection is a square.
CountedScene facing(double half = 1) {
    CountedScene s;
    s.addMirror(square({0, 5, 0}, {0, -1, 0}, half));
    s.look({0, 0, 0}, {0, 5, 0});
    return s;
}

TEST(TreeEconomies, MirrorsBelowTheLeastPixelsAreOffScreen) {
    const CountedScene s = facing();
    TreeSettings settings = settingsFor(1);
    const ReflectionTree tree = treeOf(s, settings);
    ASSERT_EQ(tree.nodes.size(), 1u);
    // 2 m at 5 m, 480 pixels for the vertical angle of one radian.
    const double side = 2 / 5.0 / (2 * std::tan(0.5)) * 480;
    EXPECT_NEAR(tree.nodes[0].pixels, side * side, 1e-6 * side * side);
    settings.leastPixels = 1.001 * side * side;
    EXPECT_TRUE(treeOf(s, settings).nodes.empty());
    EXPECT_EQ(treeOf(s, settings).counters.offScreen, 1u);
    settings.leastPixels = 0.999 * side * side;
    EXPECT_EQ(treeOf(s, settings).nodes.size(), 1u);
}

TEST(TreeEconomies, CompanionsTogetherCoverWhatEachCovers) {
    CountedScene s;
    for (double x : {-1.5, 1.5}) s.addMirror(square({x, 5, 0}, {0, -1, 0}, 1));
    s.look({0, 0, 0}, {0, 5, 0});
    const ReflectionTree apart = treeOf(s, settingsFor(1));
    ASSERT_EQ(groupCoplanar(s.mirrors), 1u);
    const ReflectionTree shared = treeOf(s, settingsFor(1));
    ASSERT_EQ(apart.nodes.size(), 2u);
    ASSERT_EQ(shared.nodes.size(), 1u);
    EXPECT_NEAR(shared.nodes[0].pixels, apart.nodes[0].pixels + apart.nodes[1].pixels, 1e-6);
}

TEST(TreeEconomies, MirrorsWithoutACompanionStayAlone) {
    CountedScene s = mirrorRoom();
    s.addMirror(square({0, 0, -1}, {0, 0, 1}, 0.2));
    EXPECT_EQ(groupCoplanar(s.mirrors), 1u);
    EXPECT_EQ(std::ranges::count_if(s.mirrors, [](const Mirror& m) { return m.group == Mirror::alone; }), 5);
}

TEST(TreeEconomies, NothingInAnImageIsMoreVisibleThanTheImage) {
    CountedScene hand = facing(0.1);  // a large ball in a small mirror
    hand.addBall({0, -6, 0}, 3);
    for (CurvedMaps curved : {CurvedMaps::none, CurvedMaps::viewDependent})
        for (const CountedScene& s : {mirrorRoom(), mirrorFloor(), mirrorPair(), mirrorCorner(), hand}) {
            const ReflectionTree tree = treeOf(s, settingsFor(3, curved));
            std::size_t nested = 0;
            for (const ReflectionNode& n : tree.nodes) {
                if (n.parent == ReflectionNode::none) continue;
                ++nested;
                const ReflectionNode& parent = tree.nodes[n.parent];
                EXPECT_LE(n.pixels, parent.pixels * (1 + 1e-9));
            }
            if (s.mirrors.size() > 1) {
                EXPECT_GT(nested, 0u);
            }
        }
}

TEST(TreeEconomies, TexelsAreThoseInsideScissorsAndThoseOfFaces) {
    for (bool scissor : {true, false}) {
        const CountedScene s = mirrorPair();
        TreeSettings settings = settingsFor(2, CurvedMaps::cube);
        settings.economies.scissor = scissor;
        settings.economies.resolution = false;
        const ReflectionTree tree = treeOf(s, settings);
        std::uint64_t texels = 12u * 128 * 128;
        for (const ReflectionNode& n : tree.nodes) {
            EXPECT_TRUE(scissor || n.scissor.area() == std::int64_t{n.resolution.x} * n.resolution.y);
            texels += static_cast<std::uint64_t>(n.scissor.area());
        }
        EXPECT_EQ(tree.counters.texels, texels);
    }
}

// Wherever a rough mirror's filter may look, three deviations from what it covers, there is a map.
TEST(TreeEconomies, RoughMirrorsHaveMapsBeyondTheirEdges) {
    CountedScene s = facing(0.5);
    roughen(s, 0.3f);
    city::Aabb between, before;
    between.extend(glm::vec3(-0.1f, 6.9f, -0.1f));  // between the glass and the eye behind it
    between.extend(glm::vec3(0.1f, 7.1f, 0.1f));
    before.extend(glm::vec3(-0.1f, 2.9f, -0.1f));
    before.extend(glm::vec3(0.1f, 3.1f, 0.1f));
    const std::vector<city::Aabb> objects{between, before};
    ReflectionScene scene = s.scene();
    scene.objects = objects;
    const TreeSettings settings = settingsFor(1);
    const ReflectionTree tree = reflectionTree(std::span(&s.view, 1), scene, settings);
    ASSERT_EQ(tree.nodes.size(), 1u);
    const ReflectionNode& node = tree.nodes[0];
    const double reach = 3 * glossAngle(0.3) * node.view.clipFromView[1][1];
    EXPECT_LE(node.crop.low.y, node.bounds.low.y - reach);
    EXPECT_GE(node.crop.high.y, node.bounds.high.y + reach);
    EXPECT_LE(node.crop.low.x, node.bounds.low.x - 3 * glossAngle(0.3) * node.view.clipFromView[0][0]);
    EXPECT_GE(node.crop.high.x, node.bounds.high.x + 3 * glossAngle(0.3) * node.view.clipFromView[0][0]);
    // No more than that and some texels.
    EXPECT_LT(node.crop.high.y, node.bounds.high.y + 1.1 * reach + 8.0 / 480);
    // Ten metres in front of the mirror, seen where the filter ends.
    const double inside = 0.99 * 3 * glossAngle(0.3);
    const glm::dvec3 ray(node.bounds.low.x / node.view.clipFromView[0][0] - inside,
                         node.bounds.low.y / node.view.clipFromView[1][1] - inside, -1);
    const glm::dvec3 far = 15.0 * (glm::transpose(node.view.viewFromWorld) * ray);
    EXPECT_TRUE(touches(node.frustum, far, 1e-3));
    const auto seen = tree.objectsOf(node);
    EXPECT_EQ(std::vector<std::uint32_t>(seen.begin(), seen.end()), std::vector<std::uint32_t>{1});
}

// A map that is interpolated needs a texel beyond what its mirror covers, wherever its edges lie among the
// texels: rounding to whole ones alone leaves any part of one.
TEST(TreeEconomies, MapsWhoseTexelsAreNotPixelsReachATexelBeyondTheirMirrors) {
    double nearest = 1e9, farthest = 0;
    for (int i = 0; i < 40; ++i) {
        const CountedScene s = facing(0.5 + 0.0137 * i);
        TreeSettings settings = settingsFor(1);
        settings.mapSize = {256, 256};
        settings.levelScale = 1;
        const ReflectionNode node = treeOf(s, settings).nodes.at(0);
        for (int axis = 0; axis < 2; ++axis) {
            const double texel = node.crop.size()[axis] / node.resolution[axis];
            for (const double beyond : {(node.bounds.low[axis] - node.crop.low[axis]) / texel,
                                        (node.crop.high[axis] - node.bounds.high[axis]) / texel}) {
                nearest = std::min(nearest, beyond);
                farthest = std::max(farthest, beyond);
            }
        }
    }
    EXPECT_GE(nearest, 1);
    EXPECT_LE(farthest, 3);
    // The picture's own texels are looked up in their middles: no more than rounding to whole ones.
    const ReflectionNode own = treeOf(facing(), settingsFor(1)).nodes.at(0);
    EXPECT_LT(own.bounds.low.x - own.crop.low.x, 2.0 / 640);
}

// By counting the pixels that a ball covers, at all places about the view, and with the eye inside.
TEST(TreeEconomies, BallsCoverThePixelsThatRaysFind) {
    std::mt19937_64 random(11);
    const auto between = [&](double low, double high) {
        return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
    };
    int whole = 0;
    for (int round = 0; round < 60; ++round) {
        const double radius = between(0.05, 3);
        CountedScene s;
        s.addBall({between(-3, 3), between(0, 8), between(-2, 2)}, radius);
        s.view.view = perspectiveView({0, 0, 0}, {0, 1, 0}, round % 2 == 0 ? 1 : 2.5, 1);
        s.view.size = {200, 200};
        const glm::dvec3 centre = s.curved[0].centre;
        int covered = 0;
        bool cut = false;
        for (int y = 0; y < 200; ++y)
            for (int x = 0; x < 200; ++x) {
                const glm::dmat4& c = s.view.view.clipFromView;
                const glm::dvec3 ray = glm::normalize(
                    glm::dvec3((0.01 * (x + 0.5) - 1) / c[0][0], 1, (0.01 * (y + 0.5) - 1) / c[1][1]));
                const double along = glm::dot(ray, centre), miss = glm::dot(centre, centre) - along * along;
                const bool inside = glm::length(centre) < radius;
                if (!inside && (along < 0 || miss > radius * radius)) continue;
                ++covered;
                cut = cut || x == 0 || y == 0 || x == 199 || y == 199;
            }
        const ReflectionTree tree = treeOf(s, settingsFor(1, CurvedMaps::viewDependent));
        if (covered == 0) continue;
        ASSERT_EQ(tree.nodes.size(), 1u);
        // What the image's edge cuts counts whole: an upper bound. In whole, to an edge's pixels.
        const double pixels = tree.nodes[0].pixels, edge = 4 * std::sqrt(covered) + 4;
        EXPECT_GE(pixels, covered - edge) << round;
        EXPECT_LE(pixels, 40000);
        if (cut) continue;
        ++whole;
        EXPECT_LE(pixels, covered + edge) << round;
    }
    EXPECT_GT(whole, 10);
    CountedScene inside;
    inside.addBall({0, 0.1, 0}, 1);
    inside.view.view = perspectiveView({0, 0, 0}, {0, 1, 0}, 2.5, 1);
    inside.view.size = {200, 200};
    EXPECT_EQ(treeOf(inside, settingsFor(1, CurvedMaps::viewDependent)).nodes.at(0).pixels, 40000);
}

// In the middle of a ball a pixel turns what it mirrors by 4 / diameter: a map has three texels for that.
TEST(TreeEconomies, ViewDependentMapsHaveThreeTexelsForAPixelInTheMiddleOfTheirBall) {
    CountedScene s;
    s.addBall({0, 5, 0}, 0.2);
    s.look({0, 0, 0}, {0, 5, 0});
    TreeSettings settings = settingsFor(1, CurvedMaps::viewDependent);
    settings.mapSize = {2048, 2048};
    const ReflectionNode node = treeOf(s, settings).nodes.at(0);
    const double diameter = 0.4 / 5 * s.view.view.clipFromView[1][1] * 240;
    const double texel = 2 / (node.clipFromView[0][0] * node.resolution.x);
    EXPECT_NEAR(4 / diameter / texel, 3, 0.2);
    settings.economies.resolution = false;
    EXPECT_EQ(treeOf(s, settings).nodes.at(0).resolution.x, 2048);
}

TEST(TreeEconomies, LevelsHaveTheShareOfTexelsThatIsAskedFor) {
    CountedScene s;
    s.addMirror(square({0, 5, 0}, {0, -1, 0}, 3));
    s.addMirror(square({0, -5, 0}, {0, 1, 0}, 3));
    s.look({0.5, 0, 0}, {0, 5, 0});
    TreeSettings settings = settingsFor(3);
    const ReflectionTree whole = treeOf(s, settings);
    settings.levelScale = 0.5;
    const ReflectionTree half = treeOf(s, settings);
    ASSERT_EQ(whole.nodes.size(), 3u);
    ASSERT_EQ(half.nodes.size(), 3u);
    for (std::size_t k = 0; k < 3; ++k) {
        const double share = std::pow(0.5, static_cast<double>(k));
        const glm::dvec2 asked = share * glm::dvec2(whole.nodes[k].resolution);
        // And up to three texels and a rounding on both sides.
        EXPECT_GE(half.nodes[k].resolution.x, asked.x - 1) << k;
        EXPECT_LE(half.nodes[k].resolution.x, asked.x + 8) << k;
        EXPECT_EQ(half.nodes[k].coarser, k + 1);
    }
    settings.economies.detail = false;
    for (const ReflectionNode& n : treeOf(s, settings).nodes) EXPECT_EQ(n.coarser, 0u);
}

TEST(TreeEconomies, AFacesMapsHaveAtMostTheTexelsAPixelThatAreAskedFor) {
    const CountedScene s = mirrorFloor();
    TreeSettings settings = settingsFor(2, CurvedMaps::cube);
    settings.mapSize = {1024, 1024};
    for (double texels : {1.0, 2.0, 4.0}) {
        settings.texelsPerPixel = texels;
        int widest = 0;
        for (const ReflectionNode& n : treeOf(s, settings).nodes)
            if (n.root > 0) widest = std::max(widest, n.resolution.x);
        EXPECT_LE(widest, static_cast<int>(128 * texels));
        EXPECT_GT(widest, static_cast<int>(100 * texels));
    }
    settings.texelsPerPixel = 0;
    EXPECT_EQ(treeOf(s, settings).status, TreeStatus::badSettings);
}

// Rough, and seen in a ball, be it through another mirror: texels as wide as the spread, not narrower.
TEST(TreeEconomies, RoughMirrorsSeenInCurvedOnesHaveTexelsAsWideAsTheirSpread) {
    const float roughness = 0.3f;
    for (CurvedMaps curved : {CurvedMaps::cube, CurvedMaps::viewDependent}) {
        CountedScene s = curved == CurvedMaps::cube ? mirrorPair() : mirrorRoom();
        roughen(s, roughness);
        TreeSettings settings = settingsFor(3, curved);
        settings.mapSize = {256, 256};
        const ReflectionTree tree = treeOf(s, settings);
        std::size_t inCurved = 0, throughMirrors = 0;
        for (const ReflectionNode& n : tree.nodes) {
            bool in = tree.roots[n.root].isEnvironment();
            for (std::uint32_t up = n.parent; up != ReflectionNode::none; up = tree.nodes[up].parent)
                in = in || !tree.nodes[up].planar();
            if (!n.planar() || !tree.roots[0].size.x) continue;
            // Radians of a texel in the middle of the view.
            const double texel =
                2 / std::max(n.clipFromView[0][0] * n.resolution.x, n.clipFromView[1][1] * n.resolution.y);
            if (!in) {
                EXPECT_LT(texel, 0.2 * glossAngle(static_cast<double>(roughness)));
                continue;
            }
            ++inCurved;
            if (n.parent != ReflectionNode::none && tree.nodes[n.parent].planar()) ++throughMirrors;
            EXPECT_GT(texel, 0.7 * glossAngle(static_cast<double>(roughness)));
            // A ball of few pixels has no more texels than it has.
            if (curved == CurvedMaps::cube) {
                EXPECT_LT(texel, 1.01 * glossAngle(static_cast<double>(roughness)));
            }
        }
        EXPECT_GT(inCurved, 4u);
        EXPECT_GT(throughMirrors, 0u) << static_cast<int>(curved);
    }
}

TEST(TreeEconomies, TheCapPrefersBrightMirrorsToSomewhatLargerDimOnes) {
    CountedScene s;
    s.addMirror(square({-1.5, 5, 0}, {0, -1, 0}, 1.1));
    s.addMirror(square({1.5, 5, 0.01}, {0, -1, 0}, 1));
    s.look({0, 0, 0}, {0, 5, 0});
    s.mirrors[0].plane = MirrorPlane::make(s.mirrors[0].plane.corners(), {glm::vec3(0.2f), 0}).mirror;
    TreeSettings settings = settingsFor(1);
    settings.mostMaps = 1;
    const ReflectionTree tree = treeOf(s, settings);
    ASSERT_EQ(tree.nodes.size(), 1u);
    EXPECT_EQ(tree.mirrorsOf(tree.nodes[0])[0], 1u);
}

TEST(TreeEconomies, BallsSeenInMirrorsAloneHaveMapsAndThoseSeenNowhereHaveNone) {
    CountedScene s = facing(2);
    s.addBall({0, -3, 0}, 0.5);   // behind the eye, in the mirror
    s.addBall({40, -3, 0}, 0.5);  // in neither
    const ReflectionTree tree = treeOf(s, settingsFor(2, CurvedMaps::cube));
    ASSERT_EQ(tree.environments.size(), 1u);
    EXPECT_EQ(tree.environments[0].curved, 0u);
    EXPECT_EQ(tree.counters.environmentsUnseen, 1u);
}

TEST(TreeEconomies, AWallDoesNotHideTheMirrorOnIt) {
    CountedScene s = facing(0.5);
    ReflectionScene scene = s.scene();
    for (double before : {1e-4, 1e-2}) {
        city::Aabb wall;
        wall.extend(glm::vec3(-3, static_cast<float>(5 - before), -3));
        wall.extend(glm::vec3(3, 6, 3));
        scene.occluders = std::span(&wall, 1);
        // A ten thousandth of the way: half a millimetre.
        EXPECT_EQ(reflectionTree(std::span(&s.view, 1), scene, settingsFor(1)).nodes.size(),
                  before < 5e-4 ? 1u : 0u);
    }
}

// Eyes so near the origin that they can be set down within a quarter of the tolerance, and four times it off.
TEST(MirrorViews, EyesInThePlaneWithinRoundingAreInThePlane) {
    std::mt19937_64 random(9);
    const auto unit = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
    int within = 0;
    for (int round = 0; round < 500; ++round) {
        const glm::dvec3 origin(unit(), unit(), unit());
        const glm::dvec3 u(1 + unit(), unit(), unit()), v(-unit(), 1 + unit(), unit());
        const std::vector<glm::dvec3> corners{origin, origin + u, origin + u + v, origin + v};
        const MirrorPlane plane = MirrorPlane::make(corners).mirror;
        const EyeView given = perspectiveView(plane.point() + (3 + 20 * unit()) * u, origin, 1, 1);
        for (const double share : {0.25, -0.25, 4.0, -4.0}) {
            EyeView view = given;
            view.eye +=
                (share * plane.sideTolerance(view.eye) - plane.signedDistance(view.eye)) * plane.normal();
            // The eye's own rounding may move it by as much as an eighth of the tolerance.
            const double off = plane.signedDistance(view.eye);
            if (std::abs(share) < 1) {
                if (off != 0) ++within;
                EXPECT_EQ(mirrorView(view, plane).status, MirrorViewStatus::eyeInPlane) << off;
            } else {
                EXPECT_EQ(mirrorView(view, plane).status,
                          share > 0 ? MirrorViewStatus::ok : MirrorViewStatus::eyeBehind)
                    << off;
            }
        }
    }
    EXPECT_GT(within, 900);
}

// Mirrors of many corners are culled by their bounds, those seen from behind by their own edges turned round.
TEST(Portals, HaveFrustaThatHoldAllThatIsSeenThroughThem) {
    std::vector<glm::dvec3> corners;
    for (int i = 0; i < 12; ++i) {
        const double a = 0.5235987755982988 * i;
        corners.emplace_back(std::cos(a), 5, std::sin(a));
    }
    const MirrorPlane round = MirrorPlane::make(corners).mirror;
    const MirrorPlane plain = MirrorPlane::make(square({0, 5, 0}, {0, -1, 0}, 1)).mirror;
    for (const MirrorPlane* mirror : {&round, &plain})
        for (double y : {0.0, 10.0}) {
            const EyeView view = perspectiveView({0.3, y, 0.2}, {0, 5, 0}, 1.0, 4.0 / 3);
            const MirrorView mirrored = mirrorView(view, *mirror);
            const Portal portal = portalThrough(view, frustumOf(view), *mirror);
            ASSERT_EQ(portal.status, PortalStatus::ok);
            const HalfSpaces frustum = frustumThrough(portal, mirrored.view, *mirror);
            EXPECT_EQ(frustum.size(), 5u);
            for (const glm::dvec3& c : mirror->corners()) {
                const glm::dvec3 at = 0.999 * (c - mirror->point()) + mirror->point() - mirrored.view.eye;
                // Along the ray beyond the glass, and, from behind, before it: the sides alone.
                for (std::size_t side = 0; side + 1 < frustum.size(); ++side)
                    EXPECT_GE(glm::dot(glm::dvec3(frustum[side]), 1.5 * at), 0) << y;
            }
        }
}

}  // namespace
}  // namespace reflection
