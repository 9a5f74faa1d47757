#include "reflection/planar/MirrorView.h"

#include <gtest/gtest.h>

#include <cmath>

#include "reflection/planar/Portal.h"
#include "tests/reflection/planar/RandomMirrors.h"

using namespace reflection;

namespace {

glm::dvec2 ndc(const EyeView& view, const glm::dvec3& p) {
    const glm::dvec4 c = view.clip(p);
    return glm::dvec2(c) / c.w;
}

MirrorPlane wall() {  // y = 0, facing -y
    return MirrorPlane::make(std::vector<glm::dvec3>{{-1, 0, -1}, {1, 0, -1}, {1, 0, 1}, {-1, 0, 1}}).mirror;
}

}  // namespace

TEST(MirrorView, ShowsAtEachPixelWhatTheMirrorShowsThere) {
    RandomMirrors random(6);
    int tried = 0;
    for (int i = 0; i < 20000; ++i) {
        const MirrorPlane m = MirrorPlane::make(random.polygon(random.between(0, 50) * random.direction(),
                                                               random.direction(), 5))
                                  .mirror;
        const glm::dvec3 eye = m.point() + random.magnitude(0.1, 100) * random.direction();
        const EyeView view = perspectiveView(eye, m.point() + 3.0 * random.direction(), 1.2, 1.5);
        const MirrorView mirrored = mirrorView(view, m);
        ASSERT_EQ(mirrored.status == MirrorViewStatus::ok, m.signedDistance(eye) > 0);
        if (mirrored.status != MirrorViewStatus::ok) continue;
        EXPECT_TRUE(mirrored.view.mirrored());
        const glm::dvec3 x = m.corners()[0] + 0.3 * (m.corners()[1] - m.corners()[0]);
        const glm::dvec3 out = m.mirroredDirection(x - eye);
        if (view.clip(x).w < 0.1) continue;
        const glm::dvec3 seen = x + random.magnitude(0.01, 100) * out;
        EXPECT_LT(glm::length(ndc(view, x) - ndc(mirrored.view, x)), 1e-9);
        EXPECT_LT(glm::length(ndc(view, x) - ndc(mirrored.view, seen)), 1e-9);
        ++tried;
    }
    EXPECT_GT(tried, 5000);
}

TEST(MirrorView, IsDefinedForEveryEye) {
    const MirrorPlane m = wall();
    const auto from = [&](const glm::dvec3& eye) {
        return mirrorView(perspectiveView(eye, {0, 5, 0}, 1, 1), m);
    };
    EXPECT_EQ(from({0, -1, 0}).status, MirrorViewStatus::ok);
    EXPECT_EQ(from({0, -1e-6, 0}).status, MirrorViewStatus::ok);
    EXPECT_NEAR(from({0, -1e-6, 0}).view.eye.y, 1e-6, 1e-18);
    EXPECT_EQ(from({0, 0, 0}).status, MirrorViewStatus::eyeInPlane);
    EXPECT_EQ(from({1000, 0, 3}).status, MirrorViewStatus::eyeInPlane);
    EXPECT_EQ(from({0, 1, 0}).status, MirrorViewStatus::eyeBehind);
    EXPECT_NEAR(from({0, 1, 0}).view.eye.y, -1, 1e-15);
    EXPECT_EQ(from({0, std::nan(""), 0}).status, MirrorViewStatus::notFinite);
    EXPECT_EQ(from({0, -1e300 * 1e300, 0}).status, MirrorViewStatus::notFinite);
}

TEST(MirrorView, GoesOnBetweenMirrorsThatFaceEachOtherExactly) {
    const MirrorPlane a = wall();
    const MirrorPlane b =
        MirrorPlane::make(std::vector<glm::dvec3>{{1, -2, -1}, {-1, -2, -1}, {-1, -2, 1}, {1, -2, 1}}).mirror;
    EyeView view = perspectiveView({0, -0.5, 0}, {0, 0, 0}, 1, 1);
    for (int level = 0; level < 32; ++level) {
        const MirrorView next = mirrorView(view, level % 2 == 0 ? a : b);
        ASSERT_EQ(next.status, MirrorViewStatus::ok);
        view = next.view;
        EXPECT_EQ(view.mirrored(), level % 2 == 0);
    }
    // Each pair of mirrors adds twice the distance between them.
    EXPECT_NEAR(std::abs(view.eye.y + 0.5), 32 * 2, 1e-9);
}

TEST(ObliqueNear, CutsAtTheMirrorAndWastesNoDepth) {
    RandomMirrors random(7);
    int tried = 0;
    for (int i = 0; i < 2000; ++i) {
        const MirrorPlane m = MirrorPlane::make(random.polygon({0, 0, 0}, random.direction(), 2)).mirror;
        const glm::dvec3 eye = random.magnitude(1e-3, 100) * random.direction();
        const EyeView given = perspectiveView(eye, m.point() + random.direction(), 1.2, 1.5);
        const MirrorView mirrored = mirrorView(given, m);
        if (mirrored.status != MirrorViewStatus::ok) continue;
        const ObliqueNear oblique = obliqueNear(mirrored.view, m);
        if (oblique.status != ObliqueStatus::ok) continue;
        EyeView view = mirrored.view;
        view.clipFromView = oblique.clipFromView;
        double farthest = 1;
        for (int k = 0; k < 200; ++k) {
            const glm::dvec2 at(k < 4 ? (k & 1) * 2 - 1 : random.between(-1, 1),
                                k < 4 ? (k & 2) - 1 : random.between(-1, 1));
            const glm::dvec3 ray(at.x / given.clipFromView[0][0], at.y / given.clipFromView[1][1], -1);
            const glm::dvec3 way = glm::transpose(mirrored.view.viewFromWorld) * ray;
            const glm::dvec3 p = mirrored.view.eye + random.magnitude(1e-2, 1e5) * way;
            const glm::dvec4 c = view.clip(p), plain = mirrored.view.clip(p);
            const double side = m.signedDistance(p), hair = 1e-9 * (1 + c.w);
            EXPECT_DOUBLE_EQ(c.x, plain.x);
            EXPECT_DOUBLE_EQ(c.w, plain.w);
            if (side > hair) {
                EXPECT_LE(c.z, c.w + hair);
            }
            if (side < -hair) {
                EXPECT_GE(c.z, c.w - hair);
            }
            if (side > hair) {
                EXPECT_GE(c.z, -hair);
            }
            EXPECT_NEAR((c.w - c.z) * oblique.scale, side, 1e-6 * (1 + std::abs(side)));
            const glm::dvec4 infinitelyFar =
                view.clipFromView * glm::dvec4(mirrored.view.viewFromWorld * way, 0);
            farthest = std::min(farthest, infinitelyFar.z / infinitelyFar.w);
        }
        EXPECT_NEAR(farthest, 0, 1e-9);  // at one of the image's corners depth reaches the far plane
        ++tried;
    }
    EXPECT_GT(tried, 500);
}

TEST(ObliqueNear, LeavesTheProjectionAloneWhereItHasNoPlaneToCutAt) {
    const MirrorPlane m = wall();
    EyeView front = perspectiveView({0, -1, 0}, {0, 5, 0}, 1, 1);
    EXPECT_EQ(obliqueNear(front, m).status, ObliqueStatus::eyeNotBehind);
    EXPECT_EQ(obliqueNear(front, m).clipFromView, front.clipFromView);
    EyeView away = perspectiveView({0, 1, 0}, {0, 5, 0}, 1, 1);
    EXPECT_EQ(obliqueNear(away, m).status, ObliqueStatus::nothingInFront);
}

// What an oblique plane costs: at an eye close to the glass hardly any depth is left for what is far.
TEST(ObliqueNear, LosesDepthPrecisionAsTheEyeComesNearTheGlass) {
    const MirrorPlane m = wall();
    double before = 0;
    for (double distance : {10.0, 1.0, 0.1, 1e-3, 1e-6}) {
        const MirrorView v = mirrorView(perspectiveView({0, -distance, 0}, {3, 3 - distance, 0}, 1, 1), m);
        ASSERT_EQ(v.status, MirrorViewStatus::ok);
        EyeView drawn = v.view;
        const double plain = depthStep(drawn.clipFromRelative(), {100, -100, 0});
        drawn.clipFromView = obliqueNear(v.view, m).clipFromView;
        const double oblique = depthStep(drawn.clipFromRelative(), {100, -100, 0});
        // Reversed depth: a relative step of 2^-24 at a near plane of 0.1 m, of any distance.
        EXPECT_LT(plain, 142 * 1.2e-7);
        EXPECT_GT(oblique, before);
        before = oblique;
    }
    EXPECT_GT(before, 1.0);
}
