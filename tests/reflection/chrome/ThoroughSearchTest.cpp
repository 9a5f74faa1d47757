#include "reflection/chrome/ThoroughSearch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "reflection/chrome/BuildReflectorMap.h"
#include "tests/reflection/chrome/Shapes.h"

namespace reflection {
namespace {

constexpr double rim = 2.0;  ///< the bowl covers polar angles from here to pi

/// All points of a unit sphere's inside that reflect the vertex lie in the plane of eye, vertex and centre:
/// sign changes of the difference of the angles along the circle there, refined by bisection.
std::vector<glm::dvec3> circleSolutions(const glm::dvec3& eye, const glm::dvec3& vertex) {
    const glm::dvec3 a = glm::normalize(eye);
    const glm::dvec3 b = glm::normalize(vertex - glm::dot(vertex, a) * a);
    const auto at = [&](double turn) { return std::cos(turn) * a + std::sin(turn) * b; };
    const auto sine = [&](double turn) {
        const glm::dvec3 p = at(turn);
        const glm::dvec3 along = -std::sin(turn) * a + std::cos(turn) * b;
        return glm::dot(glm::normalize(eye - p) + glm::normalize(vertex - p), along);
    };
    std::vector<glm::dvec3> found;
    constexpr int n = 20000;
    for (int k = 0; k < n; ++k) {
        double low = glm::two_pi<double>() * k / n, high = glm::two_pi<double>() * (k + 1) / n;
        const double atLow = sine(low);
        if (atLow * sine(high) > 0) continue;
        for (int i = 0; i < 60; ++i) {
            const double middle = 0.5 * (low + high);
            (sine(middle) * atLow > 0 ? low : high) = middle;
        }
        found.push_back(at(low));
    }
    return found;
}

TEST(ThoroughSearch, FindsAllPointsOfABowl) {
    const BuiltReflectorMap built = buildReflectorMap(
        meshOf(ellipsoid({1, 1, 1}), 300, rim, glm::pi<double>(), true), {0, 0, 0}, Bend::concave);
    ASSERT_EQ(built.status, ReflectorMapStatus::built);
    Scatter random(1);
    std::array<int, 5> times{};
    for (int k = 0; k < 600; ++k) {
        const glm::dvec3 eye = random.direction() * random.between(0.1, 0.9);
        const glm::dvec3 vertex = random.direction() * random.between(0.1, 0.9);
        std::vector<glm::dvec3> truth = circleSolutions(eye, vertex);
        bool doubtful = false;
        for (std::size_t i = 0; i < truth.size(); ++i) {
            doubtful = doubtful || std::abs(std::acos(truth[i].z) - rim) < 0.05;
            for (std::size_t j = 0; j < i; ++j)
                doubtful = doubtful || glm::length(truth[i] - truth[j]) < 0.15;
        }
        if (doubtful) continue;  // on the rim, or two about to become one
        std::erase_if(truth, [](const glm::dvec3& p) { return std::acos(p.z) < rim; });
        const std::vector<ReflectionPoint> found = findAllReflectionPoints(built.map, eye, vertex);
        ASSERT_EQ(found.size(), truth.size()) << k;
        ++times[truth.size()];
        for (const glm::dvec3& t : truth) {
            double nearest = 10;
            for (const ReflectionPoint& r : found) nearest = std::min(nearest, glm::length(r.point - t));
            EXPECT_LT(nearest, 2e-4);
        }
        for (std::size_t i = 0; i < found.size(); ++i) {
            EXPECT_LT(bisectorAngle(eye, vertex, found[i].point, found[i].normal), 1e-6);
            if (i > 0) {
                EXPECT_GE(found[i].path, found[i - 1].path);
            }
        }
    }
    EXPECT_GT(times[0], 20);
    EXPECT_GT(times[1], 50);
    EXPECT_GT(times[2] + times[3], 10);
}

TEST(ThoroughSearch, MissesNothingThatDescentsFromEverywhereFind) {
    // A bowl that is no part of a sphere, where up to five points lie close together.
    const BuiltReflectorMap built = buildReflectorMap(
        meshOf(ellipsoid({1, .8, .6}), 100, rim, glm::pi<double>(), true), {0, 0, 0}, Bend::concave);
    const ReflectorMap& map = built.map;
    std::vector<glm::dvec3> everywhere;
    for (int face = 0; face < 6; ++face)
        for (int row = 0; row < 48; ++row)
            for (int column = 0; column < 48; ++column)
                everywhere.push_back(ReflectorMap::cornerPoint(48, face, column, row));
    std::vector<Candidate> ends(everywhere.size());
    Scatter random(4);
    std::size_t points = 0, several = 0, missed = 0;
    for (int k = 0; k < 60; ++k) {
        const glm::dvec3 eye = random.direction() * random.between(0.1, 1.5);
        const glm::dvec3 vertex = random.direction() * random.between(0.1, 1.5);
        const std::vector<ReflectionPoint> all = everyReflectionPoint(map, eye, vertex, {});
        descendFromStarts(map, eye, vertex, everywhere, ends, {});
        std::vector<glm::dvec3> oracle;
        for (const Candidate& c : ends) {
            if (!(c.error <= 1e-14)) continue;
            const auto at = [&](const glm::dvec3& p) { return glm::length(p - c.point) < 1e-3; };
            if (std::any_of(oracle.begin(), oracle.end(), at)) continue;
            oracle.push_back(c.point);
            missed +=
                std::none_of(all.begin(), all.end(), [&](const ReflectionPoint& r) { return at(r.point); });
        }
        points += oracle.size();
        several += oracle.size() > 1;
    }
    EXPECT_GT(points, 60U);
    EXPECT_GT(several, 20U);
    EXPECT_EQ(missed, 0U);
}

TEST(ThoroughSearch, TheShortestPathInABowlIsThatOfAllPoints) {
    // Together and briskly, against each alone with every descent to its end.
    const BuiltReflectorMap built = buildReflectorMap(
        meshOf(ellipsoid({1, .8, .6}), 60, rim, glm::pi<double>(), true), {0, 0, 0}, Bend::concave);
    Scatter random(6);
    std::size_t found = 0;
    for (int view = 0; view < 6; ++view) {
        const glm::dvec3 eye = random.direction() * random.between(0.1, 4);
        std::vector<glm::dvec3> vertices(300);
        for (glm::dvec3& v : vertices) v = random.direction() * random.between(0.1, 4);
        std::vector<ReflectionPoint> points(vertices.size());
        findReflectionPoints(built.map, eye, vertices, points);
        for (std::size_t k = 0; k < vertices.size(); ++k) {
            const std::vector<ReflectionPoint> all = findAllReflectionPoints(built.map, eye, vertices[k]);
            ASSERT_EQ(points[k].status == ReflectionStatus::found, !all.empty()) << view << ' ' << k;
            if (all.empty()) continue;
            ++found;
            EXPECT_NEAR(points[k].path, all.front().path, 1e-6);
        }
    }
    EXPECT_GT(found, 200U);
}

TEST(ThoroughSearch, GivesOneStatusToEveryVertexAroundABowl) {
    const BuiltReflectorMap built = buildReflectorMap(
        meshOf(ellipsoid({1, 1, 1}), 100, rim, glm::pi<double>(), true), {0, 0, 0}, Bend::concave);
    Scatter random(2);
    const glm::dvec3 eye(.2, -.4, 2);
    std::vector<glm::dvec3> vertices(1500);
    for (glm::dvec3& v : vertices) v = random.direction() * random.between(0, 3);
    std::vector<ReflectionPoint> points(vertices.size());
    findReflectionPoints(built.map, eye, vertices, points);
    int found = 0, hidden = 0, unreflected = 0;
    for (std::size_t k = 0; k < points.size(); ++k) {
        const ReflectionPoint& r = points[k];
        if (r.status == ReflectionStatus::found) {
            ++found;
            EXPECT_LT(r.residual, 1e-6);
        } else if (r.status == ReflectionStatus::hidden) {
            ++hidden;
            // Behind the bowl, on a line of sight through it.
            EXPECT_GT(glm::length(vertices[k]), 0.99);
            EXPECT_GT(std::acos(glm::normalize(r.point).z), rim - 0.05);
            EXPECT_LT(glm::length(r.point - eye), glm::length(vertices[k] - eye));
        } else if (r.status == ReflectionStatus::unreflected) {
            ++unreflected;
        }
    }
    EXPECT_EQ(found + hidden + unreflected, static_cast<int>(points.size()));
    EXPECT_GT(found, 50);
    EXPECT_GT(hidden, 50);
    EXPECT_GT(unreflected, 50);
}

TEST(ThoroughSearch, AgreesWithTheQuickOneOnConvexPieces) {
    const BuiltReflectorMap built =
        buildReflectorMap(meshOf(ellipsoid({1, .7, .5}), 100), {0, 0, 0}, Bend::convex);
    Scatter random(3);
    const glm::dvec3 eye(1, -2, .5);
    std::vector<glm::dvec3> vertices(400);
    for (glm::dvec3& v : vertices) v = random.direction() * random.between(1.1, 4);
    std::vector<ReflectionPoint> points(vertices.size());
    findReflectionPoints(built.map, eye, vertices, points);
    for (std::size_t k = 0; k < points.size(); ++k) {
        const std::vector<ReflectionPoint> all = findAllReflectionPoints(built.map, eye, vertices[k]);
        if (points[k].status != ReflectionStatus::found) continue;
        ASSERT_EQ(all.size(), 1U) << k;
        EXPECT_LT(glm::length(all[0].point - points[k].point), 1e-5);
    }
}

TEST(ThoroughSearch, AgreesWithTheQuickOneOnOpenConvexPieces) {
    // A cap, a strip of a rounded box, and a narrow band: most vertices are reflected past their rims.
    struct Open {
        const char* name;
        city::Mesh mesh;
    };
    const Open pieces[]{{"cap", meshOf(ellipsoid({1, .7, .5}), 60, 0, 1.1)},
                        {"rounded box", meshOf(roundedBox({1, .4, .6}, 4), 60, 0, 1.3)},
                        {"band", meshOf(ellipsoid({1, 1, 1.5}), 60, 1.3, 1.5)}};
    for (const Open& piece : pieces) {
        SCOPED_TRACE(piece.name);
        const BuiltReflectorMap built = buildReflectorMap(piece.mesh, {0, 0, 0}, Bend::convex);
        Scatter random(17);
        int found = 0, lost = 0, invented = 0;
        for (int view = 0; view < 6; ++view) {
            const glm::dvec3 eye = random.direction() * random.between(1.3, 5);
            std::vector<glm::dvec3> vertices(60);
            for (glm::dvec3& v : vertices) v = random.direction() * random.between(1.1, 4);
            std::vector<ReflectionPoint> points(vertices.size());
            findReflectionPoints(built.map, eye, vertices, points);
            for (std::size_t k = 0; k < points.size(); ++k) {
                const bool quick = points[k].status == ReflectionStatus::found;
                const bool truly = !findAllReflectionPoints(built.map, eye, vertices[k]).empty();
                found += quick;
                lost += truly && !quick;
                invented += quick && !truly;
            }
        }
        EXPECT_GT(found, 10);
        EXPECT_EQ(lost, 0);
        EXPECT_EQ(invented, 0);
    }
}

}  // namespace
}  // namespace reflection
