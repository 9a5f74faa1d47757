#include "reflection/chrome/ReflectorMap.h"

#include <gtest/gtest.h>

#include <limits>

#include "reflection/chrome/BuildReflectorMap.h"
#include "tests/reflection/chrome/Shapes.h"

namespace reflection {
namespace {

constexpr double facets = 2e-5;  ///< 400 rings: sagitta of a facet of pi / 400, in radii

TEST(ReflectorMap, GivesASpheresNormalsExactlyAndItsPositionsToItsFacets) {
    const BuiltReflectorMap built =
        buildReflectorMap(meshOf(ellipsoid({1, 1, 1}), 400), {0, 0, 0}, Bend::convex, 32);
    ASSERT_EQ(built.status, ReflectorMapStatus::built);
    Scatter random(1);
    for (int k = 0; k < 20000; ++k) {
        const glm::dvec3 d = random.direction();
        const ReflectorMap::Sample s = built.map.sample(d);
        EXPECT_LT(glm::length(s.normal - d), 1e-6);
        EXPECT_LT(glm::length(s.position - d), 1.5 * facets);
        EXPECT_TRUE(s.covered);
    }
}

TEST(ReflectorMap, StretchMakesAnEllipsoidAsExactAsASphere) {
    const glm::dvec3 radii(2, 0.5, 0.1);
    MapFrame frame;
    frame.stretch = radii;
    const city::Mesh mesh = meshOf(ellipsoid(radii), 400);
    const BuiltReflectorMap built = buildReflectorMap(mesh, frame, true, Bend::convex, 32);
    const BuiltReflectorMap plain = buildReflectorMap(mesh, {0, 0, 0}, Bend::convex, 32);
    ASSERT_EQ(built.status, ReflectorMapStatus::built);
    Scatter random(2);
    double worst = 0, worstPlain = 0;
    for (int k = 0; k < 20000; ++k) {
        const glm::dvec3 on = random.direction() * radii;
        const glm::dvec3 normal = glm::normalize(on / radii / radii);
        const ReflectorMap::Sample s = built.map.sample(built.map.frame().toMap(on));
        worst = std::max(worst, glm::length(s.normal - normal));
        worstPlain =
            std::max(worstPlain, glm::length(plain.map.sample(plain.map.frame().toMap(on)).normal - normal));
        EXPECT_LT(glm::length(built.map.frame().fromMap(s.position) - on), 2 * facets * 2);
    }
    // What is left is the mesh's own: at the sharp end a facet turns by 0.16.
    EXPECT_LT(worst, 2e-3);
    EXPECT_GT(worstPlain, 50 * worst);
}

TEST(ReflectorMap, ReproducesAPlateToRounding) {
    const BuiltReflectorMap built = buildReflectorMap(plate(1), {0.1, -0.2, -0.6}, Bend::convex);
    ASSERT_EQ(built.status, ReflectorMapStatus::built);
    Scatter random(3);
    for (int k = 0; k < 20000; ++k) {
        // A cell's width from the rim the closing surface begins to take part.
        const glm::dvec3 on(random.between(-.95, .95), random.between(-.95, .95), 0);
        const ReflectorMap::Sample s = built.map.sample(built.map.frame().toMap(on));
        ASSERT_TRUE(s.covered);
        EXPECT_LT(glm::length(s.normal - glm::dvec3(0, 0, 1)), 1e-6);
        EXPECT_LT(glm::length(built.map.frame().fromMap(s.position) - on), 1e-6);
    }
    EXPECT_FALSE(built.map.sample({0, 0, -1}).covered);
    EXPECT_FALSE(built.map.sample({1, 0, -.2}).covered);
}

TEST(ReflectorMap, ErrorOfSmoothSurfacesFallsAsTheFourthPowerOfTheCells) {
    // An ellipsoid without its stretch; the mesh's own facets (2e-5) bound how far down this can be seen.
    const city::Mesh mesh = meshOf(ellipsoid({1, 0.6, 0.6}), 400);
    const auto error = [&](int cells) {
        return buildReflectorMap(mesh, {0, 0, 0}, Bend::convex, cells).report.worstDistance;
    };
    const double at6 = error(6), at12 = error(12);
    EXPECT_LT(at12, at6 / 10);  // second order would give a quarter
    EXPECT_GT(at6, 20 * facets);
}

TEST(ReflectorMap, IsContinuousAcrossCellsAndFaces) {
    const BuiltReflectorMap built =
        buildReflectorMap(meshOf(roundedBox({1, .7, .5}, 4), 200), {0, 0, 0}, Bend::convex, 16);
    Scatter random(4);
    for (int k = 0; k < 20000; ++k) {
        glm::dvec3 d = random.direction();
        if (k % 2 == 0) d[k / 2 % 3] = d[(k / 2 + 1) % 3];  // on an edge of the cube
        const glm::dvec3 nearby = d + 1e-9 * random.direction();
        const ReflectorMap::Sample a = built.map.sample(d), b = built.map.sample(nearby);
        EXPECT_LT(glm::length(a.position - b.position), 1e-7);
        EXPECT_LT(glm::length(a.normal - b.normal), 1e-7);
    }
}

TEST(ReflectorMap, RimKeepsTheAccuracyOfTheMiddle) {
    // Half a sphere: the cells across the rim blend the part with what closes it.
    const BuiltReflectorMap built = buildReflectorMap(
        meshOf(ellipsoid({1, 1, 1}), 400, 0, glm::half_pi<double>()), {0, 0, 0}, Bend::convex);
    ASSERT_EQ(built.status, ReflectorMapStatus::built);
    EXPECT_NEAR(built.report.coveredShare, 0.5, 0.02);
    EXPECT_LT(built.report.worstAngle, 2e-3);
    EXPECT_LT(built.report.worstDistance, 1e-4);
}

TEST(ReflectorMap, ClosesWhatIsOpenWithASurfaceAroundItsCentre) {
    for (const double cap : {0.2, 0.8, 2.0, 3.0}) {
        const BuiltReflectorMap built =
            buildReflectorMap(meshOf(ellipsoid({1, 1.2, .8}), 60, 0, cap), {0, 0, 0}, Bend::convex, 32);
        ASSERT_EQ(built.status, ReflectorMapStatus::built);
        Scatter random(5);
        for (int k = 0; k < 5000; ++k) {
            const ReflectorMap::Sample s = built.map.sample(random.direction());
            EXPECT_GT(glm::dot(s.normal, glm::normalize(s.position)), 0.02);
            EXPECT_LT(glm::length(s.position), 4.5);
            EXPECT_GT(glm::length(s.position), 0.1);
        }
    }
}

TEST(ReflectorMap, TellsWhatItCannotHold) {
    const city::Mesh ball = meshOf(ellipsoid({1, 1, 1}), 20);
    city::Mesh nested = ball;
    nested.append(meshOf(ellipsoid({.5, .5, .5}), 20));
    EXPECT_EQ(buildReflectorMap(nested, {0, 0, 0}, Bend::convex).status, ReflectorMapStatus::notStarShaped);
    EXPECT_EQ(buildReflectorMap(ball, {0, 0, 0}, Bend::concave).status, ReflectorMapStatus::nothingSeen);
    EXPECT_EQ(buildReflectorMap({}, {0, 0, 0}, Bend::convex).status, ReflectorMapStatus::nothingSeen);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(buildReflectorMap(ball, {0, nan, 0}, Bend::convex).status, ReflectorMapStatus::nothingSeen);
    MapFrame flat;
    flat.stretch = {1, 0, 1};
    EXPECT_EQ(buildReflectorMap(ball, flat, true, Bend::convex).status, ReflectorMapStatus::nothingSeen);
}

TEST(ReflectorMap, LeavesOutTrianglesThatAreNotFinite) {
    city::Mesh ball = meshOf(ellipsoid({1, 1, 1}), 40);
    const ReflectorMapReport whole = buildReflectorMap(ball, {0, 0, 0}, Bend::convex).report;
    const float nan = std::numeric_limits<float>::quiet_NaN();
    city::Vertex broken;
    broken.position = {nan, 0, 1};
    ball.addTriangle(broken, ball.vertices[5], ball.vertices[6]);
    broken.position = {1, 0, 0};
    ball.addTriangle(broken, broken, broken);
    const BuiltReflectorMap built = buildReflectorMap(ball, {0, 0, 0}, Bend::convex);
    EXPECT_EQ(built.status, ReflectorMapStatus::built);
    EXPECT_EQ(built.report.skipped, whole.skipped + 2);
    EXPECT_DOUBLE_EQ(built.report.worstDistance, whole.worstDistance);
}

}  // namespace
}  // namespace reflection
