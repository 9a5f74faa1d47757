// Reflection points searched for by the GPU against those that the processor finds on the same maps.
#include "reflection/gl/ChromeSearch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "app/display/OffscreenContext.h"
#include "reflection/chrome/BuildReflectorMap.h"
#include "reflection/chrome/ReflectionSearch.h"
#include "reflection/gl/DebugOutput.h"
#include "tests/reflection/chrome/Shapes.h"

namespace reflection {
namespace {

struct Case {
    std::string name;
    ReflectorMap map;
    double radius = 1;
    bool concave = false;
};

city::Mesh moved(city::Mesh mesh, double scale, const glm::dvec3& by) {
    for (city::Vertex& v : mesh.vertices) v.position = glm::vec3(scale * glm::dvec3(v.position) + by);
    return mesh;
}

/// Turned, away from the origin, of each magnitude of size.
std::vector<Case> cases() {
    std::vector<Case> all;
    const double turn = 0.4, c = std::cos(turn), s = std::sin(turn);
    for (const double radius : {1e-2, 1.0, 1e2}) {
        const auto add = [&](const char* name, const city::Mesh& mesh, const glm::dvec3& stretch,
                             const Bend bend) {
            MapFrame frame;
            frame.centre = radius * glm::dvec3(3, -2, 1);
            // Around the z axis of a shape that looks the same from all sides there, or about all of its own.
            if (stretch.x == stretch.y) frame.axes = {{c, s, 0}, {-s, c, 0}, {0, 0, 1}};
            frame.stretch = radius * stretch;
            const BuiltReflectorMap built =
                buildReflectorMap(moved(mesh, radius, frame.centre), frame, bend == Bend::convex, bend, 32);
            ASSERT_EQ(built.status, ReflectorMapStatus::built) << name;
            all.push_back({name, built.map, radius, bend == Bend::concave});
        };
        add("sphere", meshOf(ellipsoid({1, 1, 1}), 120), {1, 1, 1}, Bend::convex);
        add("ellipsoid", meshOf(ellipsoid({2, .8, .5}), 120), {2, .8, .5}, Bend::convex);
        add("cylinder-like", meshOf(roundedBox({.4, .4, 1.5}, 6), 120), {.4, .4, 1.5}, Bend::convex);
        add("open cap", meshOf(ellipsoid({1, 1, 1}), 120, 0, 1.2), {1, 1, 1}, Bend::convex);
        add("bowl", meshOf(ellipsoid({1, 1, 1}), 120, 2, glm::pi<double>(), true), {1, 1, 1}, Bend::concave);
    }
    return all;
}

double angleBetween(const glm::dvec3& a, const glm::dvec3& b) {
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

struct Answers {
    std::vector<ReflectionPoint> cpu;
    std::vector<GpuReflection> gpu;
};

class ChromeSearchGlTest : public ::testing::Test {
  protected:
    ~ChromeSearchGlTest() override { EXPECT_THAT(debug.errors(), testing::IsEmpty()); }

    /// Vertices relative to the map's centre.
    Answers answers(const ReflectorMap& map, const glm::dvec3& eye, const std::vector<glm::vec3>& vertices) {
        const ChromeMapBuffer onGpu(map);
        const gl::Buffer given = gl::Buffer::filled(std::span<const glm::vec3>(vertices));
        const gl::Buffer results =
            gl::Buffer::filled(std::span<const GpuReflection>(std::vector<GpuReflection>(vertices.size())));
        search.search(onGpu, eye, given.name(), vertices.size(), results.name());
        Answers both;
        both.gpu = ChromeSearch::read(results.name(), vertices.size());
        both.cpu.resize(vertices.size());
        std::vector<glm::dvec3> placed;
        for (const glm::vec3& v : vertices) placed.push_back(map.frame().centre + glm::dvec3(v));
        findReflectionPoints(map, eye, placed, both.cpu);
        return both;
    }

    app::OffscreenContext context;
    gl::DebugOutput debug;
    ChromeSearch search;
};

TEST_F(ChromeSearchGlTest, AgreesWithTheProcessorToATenThousandthOfARadian) {
    Scatter random(3);
    for (const Case& c : cases()) {
        SCOPED_TRACE(c.name + " of " + std::to_string(c.radius));
        std::size_t found = 0, hidden = 0, unreflected = 0, other = 0, differ = 0, all = 0;
        std::size_t toDouble = 0, toThorough = 0;
        double worstPoint = 0, worstMirrored = 0, worstDrawn = 0, worstHidden = 0, worstPath = 0;
        for (int view = 0; view < 4; ++view) {
            const glm::dvec3 eyeFromCentre =
                c.radius * random.direction() *
                (c.concave ? random.between(0.1, 0.9) : 3 * std::exp(random.between(0, 3)));
            const glm::dvec3 eye = c.map.frame().centre + eyeFromCentre;
            std::vector<glm::vec3> vertices(c.concave ? 48 : 1000);
            for (glm::vec3& v : vertices)
                v = glm::vec3(random.direction() * c.radius *
                              (c.concave ? random.between(0.1, 3.0) : std::exp(random.between(-0.5, 5))));
            const Answers both = answers(c.map, eye, vertices);
            const ChromeSearch::Left left = search.leftOfLast();
            toDouble += left.toDouble, toThorough += left.toThorough;
            for (std::size_t k = 0; k < vertices.size(); ++k) {
                const ReflectionPoint& r = both.cpu[k];
                const GpuReflection& g = both.gpu[k];
                ++all;
                found += g.statusOf() == ReflectionStatus::found;
                hidden += g.statusOf() == ReflectionStatus::hidden;
                unreflected += g.statusOf() == ReflectionStatus::unreflected;
                other += g.status > 2;
                if (g.statusOf() != r.status) {
                    ++differ;
                    continue;
                }
                const glm::dvec3 point(g.point), normal = glm::normalize(glm::dvec3(g.normal)),
                                                 vertex(vertices[k]);
                const glm::dvec3 placed = c.map.frame().centre + vertex;
                const glm::dvec3 expected = virtualVertex(r, placed) - eye;
                const double drawn = angleBetween(glm::dvec3(g.fromEye), expected);
                if (r.status == ReflectionStatus::hidden) worstHidden = std::max(worstHidden, drawn);
                if (r.status != ReflectionStatus::found) continue;
                worstDrawn = std::max(worstDrawn, drawn);
                worstPoint = std::max(worstPoint, angleBetween(point - eyeFromCentre, r.point - eye));
                ReflectionPoint onGpu;
                onGpu.point = point;
                onGpu.normal = normal;
                worstMirrored = std::max(
                    worstMirrored, angleBetween(virtualVertex(onGpu, vertex) - eyeFromCentre, expected));
                worstPath =
                    std::max(worstPath, std::abs(static_cast<double>(g.path) / r.path - 1) +
                                            std::abs(glm::length(glm::dvec3(g.fromEye)) / r.path - 1));
            }
        }
        // Float settles nearly all on convex pieces.
        if (!c.concave) {
            EXPECT_LT(toDouble, all / 8);
            EXPECT_LT(toThorough, all / 100);
        }
        EXPECT_EQ(other, 0u);
        EXPECT_EQ(found + hidden + unreflected, all);
        EXPECT_GT(found, all / 20);
        EXPECT_LE(worstPoint, 1e-4);
        EXPECT_LE(worstMirrored, 1e-4);
        EXPECT_LE(worstDrawn, 1e-4);
        EXPECT_LE(worstHidden, 1e-4);
        EXPECT_LE(worstPath, 1e-5);
        EXPECT_EQ(differ, 0u);
    }
}

/// Halving the way between a hidden vertex and one that is found leads to the outline, between one found and
/// one unreflected to the rim: the vertices there are told apart as the processor does, down to a float's
/// spacing.
TEST_F(ChromeSearchGlTest, TellsVerticesApartAtOutlinesAndRims) {
    Scatter random(5);
    std::size_t ways = 0, tried = 0, differ = 0;
    for (const Case& c : cases()) {
        if (c.concave) continue;
        const glm::dvec3 eye = c.radius * 6 * random.direction(), centre = c.map.frame().centre;
        const auto statusOf = [&](const glm::vec3& v) {
            const glm::dvec3 at = centre + glm::dvec3(v);
            ReflectionPoint r;
            findReflectionPoints(c.map, centre + eye, std::span(&at, 1), std::span(&r, 1));
            return r.status;
        };
        std::vector<glm::vec3> vertices;
        std::array<int, 2> ofKind{};
        for (int k = 0; k < 400 && ofKind[0] + ofKind[1] < 20; ++k) {
            glm::vec3 a(c.radius * 4 * random.direction()), b(c.radius * 4 * random.direction());
            const ReflectionStatus atA = statusOf(a), atB = statusOf(b);
            if (atA != ReflectionStatus::found || atA == atB) continue;
            if (++ofKind[atB == ReflectionStatus::hidden ? 0 : 1] > 10) continue;
            ++ways;
            for (int step = 0; step < 24; ++step) {
                const glm::vec3 middle = 0.5f * (a + b);
                vertices.push_back(middle);
                (statusOf(middle) == atA ? a : b) = middle;
            }
        }
        const Answers both = answers(c.map, centre + eye, vertices);
        tried += vertices.size();
        for (std::size_t k = 0; k < vertices.size(); ++k)
            differ += both.gpu[k].statusOf() != both.cpu[k].status;
    }
    EXPECT_GT(ways, 100u);
    EXPECT_EQ(differ, 0u) << "of " << tried;
}

TEST_F(ChromeSearchGlTest, ExtremesGetAStatusAndNoNaN) {
    constexpr float endless = std::numeric_limits<float>::infinity();
    const auto finite = [](const glm::vec3& v) {
        return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
    };
    for (const Case& c : cases()) {
        SCOPED_TRACE(c.name + " of " + std::to_string(c.radius));
        const auto r = static_cast<float>(c.radius);
        const glm::dvec3 centre = c.map.frame().centre;
        const glm::dvec3 under = c.map.sample({.3, .2, .9}).position;
        const glm::dvec3 surface = c.map.frame().fromMap(under) - centre;
        const std::vector<glm::vec3> vertices{glm::vec3(surface),
                                              glm::vec3(surface * (1 + 1e-6)),
                                              glm::vec3(surface * (1 - 1e-6)),
                                              {0, 0, 0},
                                              {1e6f, -2e6f, 5e5f},
                                              {r * 1e-30f, 0, 0},
                                              {0, 3 * r, 0},
                                              {endless, 0, 0},
                                              {0, std::numeric_limits<float>::quiet_NaN(), 0},
                                              {1e30f, 0, 0}};
        for (const glm::dvec3& eye : {glm::dvec3(0, 0, 5 * c.radius), surface * (1 + 1e-6), surface,
                                      glm::dvec3(0), glm::dvec3(1e6, 1e6, 0), glm::dvec3(vertices[6])}) {
            const Answers both = answers(c.map, centre + eye, vertices);
            for (std::size_t k = 0; k < vertices.size(); ++k) {
                const GpuReflection& g = both.gpu[k];
                if (finite(vertices[k]))
                    EXPECT_LE(g.status, 2u) << k;
                else
                    EXPECT_EQ(g.statusOf(), ReflectionStatus::invalid) << k;
                EXPECT_TRUE(finite(g.fromEye) && finite(g.point) && finite(g.normal)) << k;
                EXPECT_TRUE(std::isfinite(g.residual) && std::isfinite(g.path)) << k;
            }
        }
        const Answers nowhere = answers(c.map, glm::dvec3(NAN, 0, 0), vertices);
        for (const GpuReflection& g : nowhere.gpu) EXPECT_EQ(g.statusOf(), ReflectionStatus::invalid);
    }
}

}  // namespace
}  // namespace reflection
