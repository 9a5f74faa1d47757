#include "reflection/planar/Portal.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "reflection/planar/MirrorView.h"
#include "reflection/planar/ReflectionTree.h"
#include "tests/reflection/planar/RandomMirrors.h"

using namespace reflection;

namespace {

bool inside(const HalfSpaces& frustum, const glm::dvec3& relative, double hair) {
    for (const HalfSpace& h : frustum)
        if (glm::dot(glm::dvec3(h), relative) + h.w < -hair) return false;
    return true;
}

/// The first mirror whose front a ray meets. Slow and simple: the oracle.
struct Meeting {
    std::uint32_t mirror = 0;
    double t = 0;
    double margin = 0;  ///< distance of the hit from the polygon's border
};
std::optional<Meeting> firstMirror(const std::vector<Mirror>& mirrors, const glm::dvec3& from,
                                   const glm::dvec3& way) {
    std::optional<Meeting> best;
    for (std::uint32_t i = 0; i < mirrors.size(); ++i) {
        const MirrorPlane& m = mirrors[i].plane;
        const double towards = glm::dot(way, m.normal());
        if (towards >= 0) continue;
        const double t = -m.signedDistance(from) / towards;
        if (t <= 1e-9 || (best && best->t <= t)) continue;
        const glm::dvec3 x = from + t * way;
        double margin = 1e9;
        for (std::size_t k = 0; k < m.corners().size(); ++k) {
            const glm::dvec3 a = m.corners()[k], b = m.corners()[(k + 1) % m.corners().size()];
            margin = std::min(margin, glm::dot(glm::cross(m.normal(), glm::normalize(b - a)), x - a));
        }
        if (margin > 0) best = Meeting{i, t, margin};
    }
    return best;
}

}  // namespace

// Rays bounced from mirror to mirror find every reflection that can be seen; culling, narrowing, cropping and
// sharing must not have left out any of them.
TEST(Portal, CullingLosesNothingThatARayCanSee) {
    RandomMirrors random(8);
    std::size_t followed = 0, deep = 0;
    for (int round = 0; round < 60; ++round) {
        std::vector<Mirror> mirrors;
        for (std::uint32_t i = 0; i < 8; ++i) {
            const glm::dvec3 place = 6.0 * random.direction();
            const glm::dvec3 normal = glm::normalize(-place + 3.0 * random.direction());
            mirrors.push_back({i,
                               MirrorPlane::make(random.polygon(place, normal, random.between(1, 4))).mirror,
                               Mirror::alone});
        }
        const TreeView view{perspectiveView(2.0 * random.direction(), 2.0 * random.direction(), 1.3, 1.5),
                            {600, 400}};
        ReflectionScene scene;
        scene.mirrors = mirrors;
        TreeSettings settings;
        settings.depth = 4;
        settings.economies.cap = false;
        settings.cutOff = 0;
        settings.leastPixels = 0;
        const ReflectionTree tree = reflectionTree(std::span(&view, 1), scene, settings);
        for (int k = 0; k < 4000; ++k) {
            const glm::dvec2 at(random.between(-1, 1), random.between(-1, 1));
            const glm::dmat4& c = view.view.clipFromView;
            glm::dvec3 way =
                glm::transpose(view.view.viewFromWorld) * glm::dvec3(at.x / c[0][0], at.y / c[1][1], -1);
            glm::dvec3 from = view.view.eye;
            std::uint32_t parent = ReflectionNode::none;
            for (int level = 0; level < settings.depth; ++level) {
                const auto met = firstMirror(mirrors, from, way);
                if (!met || met->margin < 1e-6 || (level == 0 && met->t < 0.1)) break;
                std::uint32_t found = ReflectionNode::none;
                for (std::uint32_t n = 0; n < tree.nodes.size(); ++n)
                    if (tree.nodes[n].parent == parent && tree.mirrorsOf(tree.nodes[n])[0] == met->mirror)
                        found = n;
                ASSERT_NE(found, ReflectionNode::none) << "round " << round << " level " << level;
                const ReflectionNode& node = tree.nodes[found];
                from += met->t * way;
                way = mirrors[met->mirror].plane.mirroredDirection(way);
                EXPECT_TRUE(inside(node.frustum, from + 3.0 * way - node.view.eye, 1e-6));
                EXPECT_GE(at.x, node.crop.low.x - 1e-9);
                EXPECT_LE(at.x, node.crop.high.x + 1e-9);
                EXPECT_GE(at.y, node.crop.low.y - 1e-9);
                EXPECT_LE(at.y, node.crop.high.y + 1e-9);
                const glm::dvec4 seen = node.view.clip(from + 3.0 * way);
                EXPECT_NEAR(seen.x / seen.w, at.x, 1e-7);
                EXPECT_NEAR(seen.y / seen.w, at.y, 1e-7);
                parent = found;
                ++followed;
                deep += level >= 2;
            }
        }
    }
    EXPECT_GT(followed, 5000u);
    EXPECT_GT(deep, 200u);
}

TEST(Portal, AreaIsThatOfThePixelsCovered) {
    RandomMirrors random(9);
    for (int round = 0; round < 40; ++round) {
        const MirrorPlane m = MirrorPlane::make(random.polygon({0, 0, 0}, random.direction(), 2)).mirror;
        const EyeView view = perspectiveView(4.0 * random.direction(), random.direction(), 1.2, 1);
        const Portal portal = portalThrough(view, frustumOf(view), m);
        int covered = 0;
        constexpr int grid = 200;
        for (int y = 0; y < grid; ++y)
            for (int x = 0; x < grid; ++x) {
                const glm::dvec2 at((x + 0.5) / grid * 2 - 1, (y + 0.5) / grid * 2 - 1);
                glm::dvec3 way =
                    glm::transpose(view.viewFromWorld) *
                    glm::dvec3(at.x / view.clipFromView[0][0], at.y / view.clipFromView[1][1], -1);
                // Either side: a portal does not care.
                const double towards = glm::dot(way, m.normal());
                const double t = -m.signedDistance(view.eye) / towards;
                if (!(t > 0.1)) continue;
                const glm::dvec3 p = view.eye + t * way;
                bool in = true;
                for (std::size_t k = 0; k < m.corners().size(); ++k) {
                    const glm::dvec3 a = m.corners()[k], b = m.corners()[(k + 1) % m.corners().size()];
                    in = in && glm::dot(glm::cross(m.normal(), b - a), p - a) > 0;
                }
                covered += in;
            }
        // A border pixel more or less along a perimeter of at most 4 x 2 ndc.
        EXPECT_NEAR(portal.area, 4.0 * covered / (grid * grid), 4.0 * 8 / grid * 0.5 + 1e-9);
        EXPECT_EQ(portal.status == PortalStatus::ok, portal.area > 0);
        if (covered > 0) {
            EXPECT_EQ(portal.status, PortalStatus::ok);
        }
    }
}

TEST(Portal, DegenerateEyesAndPolygonsHaveAResult) {
    const MirrorPlane m =
        MirrorPlane::make(std::vector<glm::dvec3>{{-1, 0, -1}, {1, 0, -1}, {1, 0, 1}, {-1, 0, 1}}).mirror;
    const auto from = [&](const glm::dvec3& eye, const glm::dvec3& target) {
        const EyeView v = perspectiveView(eye, target, 1, 1);
        return portalThrough(v, frustumOf(v), m);
    };
    EXPECT_EQ(from({0, 0, 0}, {0, 5, 0}).status, PortalStatus::edgeOn);
    EXPECT_EQ(from({5, 0, 0}, {0, 0, 0}).status, PortalStatus::edgeOn);
    EXPECT_EQ(from({0, -5, 0}, {0, -9, 0}).status, PortalStatus::outside);
    // Nearer than the near plane, nothing is drawn of it.
    EXPECT_EQ(from({0, -1e-6, 0}, {0, 5, 0}).status, PortalStatus::outside);
    // A micrometre before the glass, looking along it: half the image.
    const Portal along = from({0, -1e-6, 0}, {0.5, -1e-6, 0});
    EXPECT_EQ(along.status, PortalStatus::ok);
    EXPECT_LT(along.area, 1e-4);
    for (const glm::dvec3& p : along.polygon) EXPECT_TRUE(std::isfinite(p.x + p.y + p.z));
}

TEST(Portal, PixelsHoldTheRectangle) {
    EXPECT_EQ(pixelsOf({{-1, -1}, {1, 1}}, {640, 480}), (PixelRect{{0, 0}, {640, 480}}));
    EXPECT_EQ(pixelsOf({{-0.01, 0}, {0.01, 0.5}}, {100, 100}), (PixelRect{{49, 49}, {51, 76}}));
    EXPECT_TRUE(pixelsOf({{2, 2}, {3, 3}}, {100, 100}).empty());
    const PixelRect r{{10, 20}, {30, 50}};
    const NdcRect n = ndcOf(r, {64, 64});
    EXPECT_NEAR(n.low.x, 10 / 32.0 - 1, 1e-15);
    EXPECT_NEAR(n.high.y, 50 / 32.0 - 1, 1e-15);
}
