#include "reflection/planar/MirrorPlane.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/reflection/planar/RandomMirrors.h"

using namespace reflection;

// The eye, the point where it sees another point in the mirror, and that point, whatever their sizes and
// wherever they lie.
TEST(MirrorPlane, ObeysTheLawOfReflectionOverMagnitudes) {
    RandomMirrors random(4);
    double worstAngle = 0, worstPlane = 0, worstPath = 0;
    for (int i = 0; i < 200000; ++i) {
        const glm::dvec3 place = random.magnitude(1e-3, 1e6) * random.direction();
        const glm::dvec3 n = random.direction();
        const MirrorResult made = MirrorPlane::make(random.polygon(place, n, random.magnitude(1e-3, 1e6)));
        ASSERT_EQ(made.status, MirrorStatus::ok) << remedyOf(made.status);
        const MirrorPlane& m = made.mirror;
        // So high above the plane, so far along it.
        const auto inFront = [&] {
            const glm::dvec3 along = glm::normalize(glm::cross(m.normal(), random.direction()));
            return m.point() + random.magnitude(1e-3, 1e6) * m.normal() + random.magnitude(1e-3, 1e6) * along;
        };
        const glm::dvec3 eye = inFront(), p = inFront();
        const glm::dvec3 image = m.mirrored(p);
        const double he = m.signedDistance(eye), hp = m.signedDistance(p);
        const glm::dvec3 x = eye + he / (he + hp) * (image - eye);
        const glm::dvec3 in = glm::normalize(eye - x), out = glm::normalize(p - x);
        worstAngle = std::max(worstAngle, std::abs(glm::dot(in, m.normal()) - glm::dot(out, m.normal())));
        worstPlane = std::max(worstPlane, glm::length(glm::cross(in + out, m.normal())));
        const double way = glm::length(eye - x) + glm::length(p - x);
        worstPath = std::max(worstPath, std::abs(way / glm::length(image - eye) - 1));
    }
    EXPECT_LT(worstAngle, 1e-6);
    EXPECT_LT(worstPlane, 1e-6);
    EXPECT_LT(worstPath, 1e-6);
    EXPECT_GT(worstAngle, 0);
}

TEST(MirrorPlane, ItsMatrixIsTheTextbooksAndItsOwnInverse) {
    RandomMirrors random(5);
    for (int i = 0; i < 1000; ++i) {
        const auto m =
            MirrorPlane::make(random.polygon(10.0 * random.direction(), random.direction(), 1)).mirror;
        const glm::dvec3 p = 10.0 * random.direction();
        const glm::dvec3 away = 2 * glm::dot(m.normal(), m.point()) * m.normal();
        EXPECT_LT(glm::length(m.reflection() * p + away - m.mirrored(p)), 1e-12);
        EXPECT_LT(glm::length(m.mirrored(m.mirrored(p)) - p), 1e-12);
        EXPECT_NEAR(glm::determinant(m.reflection()), -1, 1e-12);
        EXPECT_NEAR(m.signedDistance(m.mirrored(p)), -m.signedDistance(p), 1e-12);
        const glm::dvec3 d = random.direction();
        EXPECT_LT(glm::length(m.reflection() * d - m.mirroredDirection(d)), 1e-14);
    }
}

TEST(MirrorPlane, RefusesWhatIsNoMirrorAndSaysWhy) {
    using Corners = std::vector<glm::dvec3>;
    const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
    const auto status = [](const Corners& c, const MirrorSurface& s = {}) {
        return MirrorPlane::make(c, s).status;
    };
    const Corners good{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    EXPECT_EQ(status(good), MirrorStatus::ok);
    EXPECT_EQ(status({}), MirrorStatus::tooFewCorners);
    EXPECT_EQ(status({{0, 0, 0}, {1, 0, 0}}), MirrorStatus::tooFewCorners);
    EXPECT_EQ(status({{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {0, 0, 0}}), MirrorStatus::tooFewCorners);
    EXPECT_EQ(status({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}), MirrorStatus::degenerate);
    EXPECT_EQ(status({{1e6, 0, 0}, {1e6 + 1e-3, 0, 0}, {1e6, 1e-3, 0}}), MirrorStatus::ok);
    EXPECT_EQ(status({{-1e308, 0, 0}, {1e308, 0, 0}, {0, 1e308, 0}}), MirrorStatus::degenerate);
    EXPECT_EQ(status({{0, 0, 0}, {nan, 0, 0}, {1, 1, 0}}), MirrorStatus::notFinite);
    EXPECT_EQ(MirrorPlane::make(Corners{{0, 0, 0}, {1, 0, 0}, {1, inf, 0}}).corner, 2u);
    EXPECT_EQ(status({{0, 0, 0}, {1, 0, 0}, {1, 1, 0.1}, {0, 1, 0}}), MirrorStatus::notPlanar);
    EXPECT_EQ(status({{0, 0, 0}, {2, 0, 0}, {0.5, 0.5, 0}, {0, 2, 0}}), MirrorStatus::notConvex);
    EXPECT_EQ(status({{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 2, 0}}), MirrorStatus::notConvex);
    Corners star;
    for (int i = 0; i < 5; ++i) star.emplace_back(std::cos(2.513274 * i), std::sin(2.513274 * i), 0);
    EXPECT_EQ(status(star), MirrorStatus::notConvex);
    EXPECT_EQ(status(good, {glm::vec3(0.5f, 1.5f, 0), 0}), MirrorStatus::badReflectance);
    EXPECT_EQ(status(good, {glm::vec3(0.5f), -0.1f}), MirrorStatus::badRoughness);
    EXPECT_EQ(status(good, {glm::vec3(std::nanf("")), 0}), MirrorStatus::notFinite);
    for (int s = 0; s <= static_cast<int>(MirrorStatus::badRoughness); ++s)
        EXPECT_NE(remedyOf(static_cast<MirrorStatus>(s)), "unknown");
}

TEST(MirrorPlane, TellsCoplanarMirrorsFromParallelAndOpposedOnes) {
    const auto at = [](double y, bool turned) {
        std::vector<glm::dvec3> c{{0, y, 0}, {1, y, 0}, {1, y, 1}, {0, y, 1}};
        if (turned) std::reverse(c.begin(), c.end());
        return MirrorPlane::make(c).mirror;
    };
    EXPECT_TRUE(coplanar(at(0, false), at(5e-4, false)));
    EXPECT_FALSE(coplanar(at(0, false), at(2e-3, false)));
    EXPECT_FALSE(coplanar(at(0, false), at(0, true)));
}
