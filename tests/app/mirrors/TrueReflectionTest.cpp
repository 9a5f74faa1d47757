// The slow oracle of reflection points, against the law of reflection and against paths' lengths.
#include "app/mirrors/TrueReflection.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "app/mirrors/Lathe.h"
#include "app/mirrors/LitShapes.h"

namespace app {
namespace {

MirrorWorld::Curved ball() {
    MirrorWorld::Curved c;
    c.reflector.centre = {1, 2, 3};
    c.reflector.radius = 0.5;
    c.mesh = litBall(glm::vec3(1, 2, 3), 0.5f, 32, 24, glm::vec3(1));
    return c;
}

MirrorWorld::Curved bowl() {
    Lathe lathe;
    lathe.profile = {{1, 0.7}, {0.8, 0.3}, {0.4, 0.06}, {0, 0}};
    lathe.steps = 6;
    lathe.slices = 48;
    MirrorWorld::Curved c;
    c.surface = std::make_shared<const LatheSurface>(lathe);
    c.mesh = c.surface->mesh(glm::vec3(1), glm::vec3(1));
    c.reflector.centre = {0, 0, 0.35};
    c.reflector.radius = 1.1;
    return c;
}

TEST(TrueReflection, OfABallLiesInThePlaneOfEyeAndVertexAndObeysTheLaw) {
    const MirrorWorld::Curved mirror = ball();
    const TrueReflection truth(mirror);
    const glm::dvec3 c = mirror.reflector.centre, eye = c + glm::dvec3(2, 0, 0),
                     vertex = c + glm::dvec3(0, 2, 0);
    const std::vector<TruePoint> found = truth.all(eye, vertex);
    ASSERT_EQ(found.size(), 1u);
    const double s = 0.5 * std::sqrt(0.5);
    EXPECT_LT(glm::distance(found[0].position, c + glm::dvec3(s, s, 0)), 1e-9);
    EXPECT_TRUE(truth.all(eye, c + glm::dvec3(-2, 0.1, 0)).empty()) << "hidden behind the ball";
}

TEST(TrueReflection, PathsOfABowlAreStationaryAndSorted) {
    const MirrorWorld::Curved mirror = bowl();
    const TrueReflection truth(mirror);
    const glm::dvec3 eye(0.9, -1.2, 1.8);
    int several = 0;
    for (int k = 0; k < 40; ++k) {
        const glm::dvec3 vertex(0.02 * k - 0.4, 0.3 - 0.01 * k, 0.3 + 0.05 * k);
        const std::vector<TruePoint> found = truth.all(eye, vertex);
        several += found.size() > 1;
        double last = 0;
        for (const TruePoint& p : found) {
            EXPECT_GE(p.path, last);
            last = p.path;
            // Fermat: moved along the surface by h, the path changes by no more than h squared over the
            // smallest distance at hand.
            const glm::dvec3 u = glm::normalize(glm::cross(p.normal, glm::dvec3(1, 2, 3)));
            for (const glm::dvec3& along : {u, glm::cross(p.normal, u)}) {
                const double h = 1e-4;
                const glm::dvec3 q = mirror.surface->nearest(p.position + h * along).position;
                const double path = glm::distance(eye, q) + glm::distance(q, vertex);
                EXPECT_LT(std::abs(path - p.path), 20 * h * h);
            }
        }
    }
    EXPECT_GT(several, 0);
}

TEST(TrueReflection, OfTwoPointsBetweenTheSameCornersAWalkFromBesidesFindsTheOther) {
    const MirrorWorld::Curved coarse = bowl();
    MirrorWorld::Curved fine = coarse;
    Lathe lathe;
    lathe.profile = {{1, 0.7}, {0.8, 0.3}, {0.4, 0.06}, {0, 0}};
    lathe.steps = 24;
    lathe.slices = 192;
    fine.mesh = LatheSurface(lathe).mesh(glm::vec3(1), glm::vec3(1));
    const TrueReflection truth(coarse), finer(fine);
    const glm::dvec3 eye(0.9, -1.2, 1.8);
    int more = 0;
    for (int k = 0; k < 400; ++k) {
        const glm::dvec3 vertex(0.0041 * k - 0.8, 0.5 - 0.0023 * k, 0.2 + 0.0052 * k);
        const std::vector<TruePoint> alone = truth.all(eye, vertex), known = finer.all(eye, vertex);
        std::vector<glm::dvec3> besides;
        for (const TruePoint& p : known) besides.push_back(p.position);
        const std::vector<TruePoint> both = truth.all(eye, vertex, besides);
        more += both.size() > alone.size();
        EXPECT_GE(both.size(), alone.size());
        for (const TruePoint& p : known) {
            double nearest = INFINITY;
            for (const TruePoint& q : both)
                nearest = std::min(nearest, glm::distance(p.position, q.position));
            EXPECT_LT(nearest, 1e-5) << k;
        }
        for (const TruePoint& p : both) EXPECT_LT(p.residual, 1e-8);
    }
    EXPECT_GT(more, 0);
    EXPECT_EQ(truth.all(eye, {0, 0, 1}, std::vector{glm::dvec3(NAN, 0, 0)}).size(),
              truth.all(eye, {0, 0, 1}).size());
}

}  // namespace
}  // namespace app
