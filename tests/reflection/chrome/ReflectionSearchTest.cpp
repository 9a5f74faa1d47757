#include "reflection/chrome/ReflectionSearch.h"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <map>
#include <string>

#include "reflection/chrome/BuildReflectorMap.h"
#include "tests/reflection/EveryInstructionSet.h"
#include "tests/reflection/chrome/Shapes.h"

namespace reflection {
namespace {

struct Case {
    std::string name;
    StarShape shape;
    MapFrame frame;
};

std::vector<Case> convexShapes() {
    std::vector<Case> cases;
    const auto add = [&](const char* name, StarShape shape, const glm::dvec3& stretch) {
        MapFrame frame;
        frame.stretch = stretch;
        cases.push_back({name, std::move(shape), frame});
    };
    add("sphere", ellipsoid({1, 1, 1}), {1, 1, 1});
    add("ellipsoid", ellipsoid({2, 1, .7}), {1, 1, 1});
    add("stretched ellipsoid", ellipsoid({2, .5, .1}), {2, .5, .1});
    add("cylinder-like", roundedBox({.3, .3, 2}, 6), {.3, .3, 2});
    add("bumper-like", roundedBox({.9, .12, .1}, 4), {.9, .12, .1});
    return cases;
}

double residualOf(const ReflectionPoint& r, const glm::dvec3& eye, const glm::dvec3& vertex) {
    return bisectorAngle(eye, vertex, r.point, r.normal);
}

/// Where a unit sphere reflects the vertex: in the plane of eye, vertex and centre the difference of the two
/// angles grows from one's direction to the other's, so bisection finds its zero.
glm::dvec3 sphereReflection(const glm::dvec3& eye, const glm::dvec3& vertex) {
    const glm::dvec3 a = glm::normalize(eye);
    glm::dvec3 b = vertex - glm::dot(vertex, a) * a;
    if (glm::length(b) < 1e-12) return a;
    b = glm::normalize(b);
    double low = 0, high = std::atan2(glm::dot(vertex, b), glm::dot(vertex, a));
    for (int k = 0; k < 200; ++k) {
        const double middle = 0.5 * (low + high);
        const glm::dvec3 n = std::cos(middle) * a + std::sin(middle) * b;
        const double towardsEye = glm::dot(glm::normalize(eye - n), n);
        const double towardsVertex = glm::dot(glm::normalize(vertex - n), n);
        (towardsEye > towardsVertex ? low : high) = middle;
    }
    return std::cos(low) * a + std::sin(low) * b;
}

TEST(ReflectionSearch, AgreesWithTheSpheresOwnSolution) {
    const BuiltReflectorMap built =
        buildReflectorMap(meshOf(ellipsoid({1, 1, 1}), 700), {0, 0, 0}, Bend::convex);
    Scatter random(1);
    int found = 0;
    for (int view = 0; view < 20; ++view) {
        const glm::dvec3 eye = random.direction() * random.between(1.2, 20);
        std::vector<glm::dvec3> vertices(500);
        for (glm::dvec3& v : vertices) v = random.direction() * random.between(1.01, 10);
        std::vector<ReflectionPoint> points(vertices.size());
        findReflectionPoints(built.map, eye, vertices, points);
        for (std::size_t k = 0; k < vertices.size(); ++k) {
            if (points[k].status != ReflectionStatus::found) continue;
            const glm::dvec3 truth = sphereReflection(eye, vertices[k]);
            // Towards grazing incidence the solution is badly conditioned: the direction there is the eye's.
            const double grazing = glm::dot(glm::normalize(eye - truth), truth);
            if (grazing < 0.05) continue;
            ++found;
            EXPECT_LT(glm::length(points[k].point - truth), 1e-5) << "cosine " << grazing;
            // Both legs end on a facet.
            EXPECT_NEAR(points[k].path, glm::length(eye - truth) + glm::length(vertices[k] - truth), 2e-5);
        }
    }
    EXPECT_GT(found, 5000);
}

TEST(ReflectionSearch, AgreesWithAPlatesMirrorPoint) {
    const BuiltReflectorMap built = buildReflectorMap(plate(1), {0, 0, -0.6}, Bend::convex);
    Scatter random(2);
    int found = 0;
    std::vector<glm::dvec3> vertices(4000);
    std::vector<ReflectionPoint> points(vertices.size());
    const glm::dvec3 eye(.3, -2, 1.5);
    for (glm::dvec3& v : vertices)
        v = {random.between(-3, 3), random.between(-3, 3), std::pow(10, random.between(-3, 2))};
    findReflectionPoints(built.map, eye, vertices, points);
    for (std::size_t k = 0; k < vertices.size(); ++k) {
        const glm::dvec3& v = vertices[k];
        const glm::dvec3 mirror = v + (v.z / (v.z + eye.z)) * (glm::dvec3(eye.x, eye.y, -eye.z) - v);
        const glm::dvec3 truth(mirror.x, mirror.y, 0);
        const double inside = 1 - std::max(std::abs(truth.x), std::abs(truth.y));
        if (inside > 0.05) {
            ++found;
            ASSERT_EQ(points[k].status, ReflectionStatus::found) << v.x << ' ' << v.y << ' ' << v.z;
            EXPECT_LT(glm::length(points[k].point - truth), 1e-5);
            EXPECT_LT(glm::length(virtualVertex(points[k], v) - glm::dvec3(v.x, v.y, -v.z)),
                      3e-5 * (1 + v.z));
        } else if (inside < -0.05) {
            EXPECT_NE(points[k].status, ReflectionStatus::found);
        }
    }
    EXPECT_GT(found, 400);
}

TEST(ReflectionSearch, EveryVertexIsFoundHiddenOrUnreflectedAndNoneIsLost) {
    for (const Case& c : convexShapes()) {
        SCOPED_TRACE(c.name);
        const city::Mesh mesh = meshOf(c.shape, 200);
        const BuiltReflectorMap built = buildReflectorMap(mesh, c.frame, true, Bend::convex);
        ASSERT_EQ(built.status, ReflectorMapStatus::built);
        const double reach = built.map.frame().scale;
        Scatter random(3);
        std::array<int, 5> counts{};
        for (int view = 0; view < 24; ++view) {
            const glm::dvec3 eye = random.direction() * reach * random.between(1.1, 6);
            const glm::dvec3 middle = random.direction() * reach * random.between(0.5, 4);
            std::vector<glm::dvec3> vertices(400);
            for (glm::dvec3& v : vertices) v = middle + random.direction() * reach * random.between(0, 2);
            std::vector<ReflectionPoint> points(vertices.size());
            findReflectionPoints(built.map, eye, vertices, points);
            for (std::size_t k = 0; k < vertices.size(); ++k) {
                const ReflectionPoint& r = points[k];
                ++counts[static_cast<std::size_t>(r.status)];
                ASSERT_TRUE(std::isfinite(r.point.x + r.point.y + r.point.z + r.path + r.residual));
                if (r.status == ReflectionStatus::found) {
                    EXPECT_LT(r.residual, 1e-6);
                    EXPECT_LT(residualOf(r, eye, vertices[k]), 1e-6);
                    const glm::dvec3 image = virtualVertex(r, vertices[k]) - eye;
                    EXPECT_NEAR(glm::length(image), r.path, 1e-6 * r.path);
                    EXPECT_LT(glm::length(glm::cross(glm::normalize(image), glm::normalize(r.point - eye))),
                              3e-6);
                } else {
                    // Of a closed convex body only what lies behind it is not reflected. The line of sight's
                    // nearest approach in the map says so independently.
                    double nearest = 10;
                    for (int s = 0; s <= 2000; ++s) {
                        const glm::dvec3 p = eye + (s / 2000.0) * (vertices[k] - eye);
                        nearest = std::min(nearest, built.map.sample(built.map.frame().toMap(p)).gauge);
                    }
                    EXPECT_LT(nearest, 1.001);
                }
            }
        }
        EXPECT_EQ(counts[static_cast<std::size_t>(ReflectionStatus::outOfSteps)], 0);
        EXPECT_EQ(counts[static_cast<std::size_t>(ReflectionStatus::invalid)], 0);
        EXPECT_GT(counts[static_cast<std::size_t>(ReflectionStatus::found)], 3000);
        EXPECT_GT(counts[static_cast<std::size_t>(ReflectionStatus::hidden)], 100);
        // A few graze the silhouette.
        EXPECT_LT(counts[static_cast<std::size_t>(ReflectionStatus::unreflected)], 20);
    }
}

TEST(ReflectionSearch, HiddenVerticesLieBehindTheirPointAndContinueTheVirtualImage) {
    const BuiltReflectorMap built =
        buildReflectorMap(meshOf(ellipsoid({1, 1, 1}), 200), {0, 0, 0}, Bend::convex);
    const glm::dvec3 eye(0, -4, 0);
    const auto at = [](double x) { return glm::dvec3(x, 2, 0.3); };
    const auto search = [&](const glm::dvec3& vertex) {
        ReflectionPoint r;
        findReflectionPoints(built.map, eye, std::span(&vertex, 1), std::span(&r, 1));
        return r;
    };
    double behind = 0.2, beside = 2.2;
    ASSERT_EQ(search(at(behind)).status, ReflectionStatus::hidden);
    ASSERT_EQ(search(at(beside)).status, ReflectionStatus::found);
    for (double x = behind; x < 1.4; x += 0.05) {
        const ReflectionPoint r = search(at(x));
        ASSERT_EQ(r.status, ReflectionStatus::hidden);
        EXPECT_LT(glm::length(glm::cross(glm::normalize(r.point - eye), glm::normalize(at(x) - eye))), 1e-9);
        EXPECT_GT(glm::dot(r.normal, glm::normalize(eye - r.point)), 0);
    }
    // Across the sphere's outline the image moves without a jump, though infinitely fast: as the root of the
    // way.
    for (int k = 0; k < 60; ++k) {
        const double middle = 0.5 * (behind + beside);
        (search(at(middle)).status == ReflectionStatus::hidden ? behind : beside) = middle;
    }
    const double step = 1e-9;
    const glm::dvec3 before = virtualVertex(search(at(behind - step)), at(behind - step));
    const glm::dvec3 after = virtualVertex(search(at(beside + step)), at(beside + step));
    EXPECT_LT(glm::length(after - before), 1e-3);
    EXPECT_LT(glm::length(before - at(behind)), 1e-3);
}

TEST(ReflectionSearch, InstructionSetsAgree) {
    const BuiltReflectorMap built =
        buildReflectorMap(meshOf(roundedBox({1, .5, .4}, 4), 100), {0, 0, 0}, Bend::convex);
    Scatter random(4);
    std::vector<glm::dvec3> vertices(1001);
    for (glm::dvec3& v : vertices) v = random.direction() * random.between(0.3, 5);
    const glm::dvec3 eye(1.5, -1, .7);
    std::vector<ReflectionPoint> first;
    onEveryInstructionSet([&] {
        std::vector<ReflectionPoint> points(vertices.size());
        findReflectionPoints(built.map, eye, vertices, points);
        if (first.empty()) first = points;
        for (std::size_t k = 0; k < points.size(); ++k) {
            EXPECT_EQ(points[k].status, first[k].status);
            EXPECT_LT(glm::length(points[k].point - first[k].point), 1e-6);
        }
    });
}

TEST(ReflectionSearch, GivesTheSameNumbersAtEveryScale) {
    Scatter random(5);
    std::vector<glm::dvec3> unit(500);
    for (glm::dvec3& v : unit) v = random.direction() * random.between(0.5, 6);
    std::vector<ReflectionPoint> first;
    for (const double radius : {1.0, 1e-3, 1e3}) {
        const BuiltReflectorMap built =
            buildReflectorMap(meshOf(ellipsoid(radius * glm::dvec3(1, .8, .6)), 60), {0, 0, 0}, Bend::convex);
        std::vector<glm::dvec3> vertices;
        for (const glm::dvec3& v : unit) vertices.push_back(radius * v);
        std::vector<ReflectionPoint> points(vertices.size());
        findReflectionPoints(built.map, radius * glm::dvec3(2, 1, 1), vertices, points);
        if (first.empty()) first = points;
        for (std::size_t k = 0; k < points.size(); ++k) {
            EXPECT_EQ(points[k].status, first[k].status);
            EXPECT_LT(glm::length(points[k].point / radius - first[k].point), 1e-5);
        }
    }
}

TEST(ReflectionSearch, AnswersAtTheExtremes) {
    const BuiltReflectorMap built =
        buildReflectorMap(meshOf(ellipsoid({1, 1, 1}), 100), {0, 0, 0}, Bend::convex);
    const ReflectorMap& map = built.map;
    const glm::dvec3 onSurface = map.frame().fromMap(map.sample({.3, .5, .7}).position);
    const double nan = std::numeric_limits<double>::quiet_NaN(),
                 infinity = std::numeric_limits<double>::infinity();
    const std::vector<glm::dvec3> vertices{
        {0, 0, 0}, onSurface,  1.0000001 * onSurface, {1e6, 2e6, -1e6}, {0, 0, 1e6},     {1e-12, 0, 0},
        {0, 0, 3}, {0, 0, -3}, {nan, 0, 0},           {infinity, 0, 0}, 0.9 * onSurface, {0, 3, 0}};
    for (const glm::dvec3 eye : {glm::dvec3(0, 0, 3), glm::dvec3(0, 0, 1e6), 1.0000001 * onSurface, onSurface,
                                 glm::dvec3(0, 0, 0.2), glm::dvec3(0), glm::dvec3(nan, 1, 2)}) {
        std::vector<ReflectionPoint> points(vertices.size());
        findReflectionPoints(map, eye, vertices, points);
        for (std::size_t k = 0; k < points.size(); ++k) {
            const ReflectionPoint& r = points[k];
            SCOPED_TRACE(testing::Message()
                         << "eye " << eye.x << ' ' << eye.y << ' ' << eye.z << " vertex " << k);
            EXPECT_TRUE(std::isfinite(r.point.x + r.point.y + r.point.z + r.path + r.residual));
            EXPECT_NE(r.status, ReflectionStatus::outOfSteps);
            const bool broken = std::isnan(eye.x) || !std::isfinite(vertices[k].x);
            EXPECT_EQ(r.status == ReflectionStatus::invalid, broken);
            if (glm::length(eye) < 0.5) {
                EXPECT_TRUE(broken || r.status == ReflectionStatus::unreflected);
            }
        }
    }
    // A vertex on the surface that the eye sees is its own reflection point.
    std::vector<ReflectionPoint> one(1);
    findReflectionPoints(map, 3.0 * onSurface, std::span(&vertices[2], 1), one);
    EXPECT_EQ(one[0].status, ReflectionStatus::found);
    EXPECT_LT(glm::length(one[0].point - onSurface), 1e-5);

    std::vector<ReflectionPoint> none(vertices.size());
    findReflectionPoints({}, {0, 0, 3}, vertices, none);
    for (const ReflectionPoint& r : none) EXPECT_EQ(r.status, ReflectionStatus::invalid);
}

TEST(ReflectionSearch, PublishedSearchApproachesOursWithItsSteps) {
    const BuiltReflectorMap built =
        buildReflectorMap(meshOf(ellipsoid({1, .8, .6}), 100), {0, 0, 0}, Bend::convex);
    Scatter random(6);
    std::vector<glm::dvec3> vertices(2000);
    for (glm::dvec3& v : vertices) v = glm::dvec3(1.5, -2, 1) + random.direction() * random.between(0, 1);
    const glm::dvec3 eye(-1, -3, 1);
    std::vector<ReflectionPoint> ours(vertices.size()), theirs(vertices.size());
    findReflectionPoints(built.map, eye, vertices, ours);
    double before = 1e9;
    for (const int steps : {3, 5, 7, 9}) {
        findReflectionPointsAsPublished(built.map, eye, vertices, theirs, {.steps = steps});
        double sum = 0;
        for (std::size_t k = 0; k < vertices.size(); ++k) {
            ASSERT_EQ(ours[k].status, ReflectionStatus::found);
            sum += theirs[k].residual;
            EXPECT_EQ(theirs[k].lookups, 2 * steps);
        }
        EXPECT_LT(sum, before) << steps;
        before = sum;
    }
    EXPECT_LT(before / static_cast<double>(vertices.size()), 0.01);
}

}  // namespace
}  // namespace reflection
