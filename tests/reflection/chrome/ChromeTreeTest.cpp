// What chrome parts show of each other: planned counts, and pictures from one eye against rays of two
// bounces.
#include "reflection/chrome/ChromeTree.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <optional>
#include <random>

#include "tests/reflection/chrome/Shapes.h"

namespace reflection {
namespace {

struct Ball {
    Ball(const glm::dvec3& c, double r, int cells = 64) : centre(c), radius(r) {
        ReflectorPiece& piece = reflector.pieces.emplace_back();
        piece.mesh = meshOf(ellipsoid(glm::dvec3(r)), 48);
        for (city::Vertex& v : piece.mesh.vertices) v.position += glm::vec3(c);
        piece.built = buildReflectorMap(piece.mesh, c, Bend::convex, cells);
        points.push_back(spreadPoints(piece.mesh, 48));
    }
    ChromeBody body(double reach = 100) const {
        ChromeBody b;
        b.reflector = &reflector;
        b.points = points;
        b.centre = centre;
        b.radius = radius;
        b.reach = reach;
        return b;
    }
    const ReflectorMap& map() const { return reflector.pieces[0].built.map; }

    glm::dvec3 centre;
    double radius;
    Reflector reflector;
    std::vector<std::vector<SurfacePoint>> points;
};

struct Hit {
    glm::dvec3 point{0}, onward{0};
};
/// Where a ray meets a ball, and how it goes on.
std::optional<Hit> bounce(const Ball& ball, const glm::dvec3& from, const glm::dvec3& d) {
    const glm::dvec3 c = from - ball.centre;
    const double b = glm::dot(c, d), disc = b * b - glm::dot(c, c) + ball.radius * ball.radius;
    if (disc <= 0 || -b - std::sqrt(disc) <= 1e-9) return {};
    Hit hit;
    hit.point = from + (-b - std::sqrt(disc)) * d;
    hit.onward = glm::normalize(glm::reflect(d, (hit.point - ball.centre) / ball.radius));
    return hit;
}

ChromeTree treeOf(std::span<const ChromeBody> bodies, const glm::dvec3& eye, const glm::dvec3& target,
                  const ChromeTreeOptions& options, glm::ivec2 size = {1280, 720}) {
    return chromeTree(perspectiveView(eye, target, 0.6, static_cast<double>(size.x) / size.y, 0.01), size,
                      bodies, options);
}

const glm::dvec3 before(0, -6, 0.5);

TEST(ChromeTree, CountsAreThoseOfTwoBallsThatSeeEachOther) {
    const Ball a({-0.8, 0, 0}, 0.4), b({0.8, 0, 0}, 0.4);
    const std::vector<ChromeBody> bodies{a.body(), b.body()};
    for (int depth = 1; depth <= 5; ++depth) {
        ChromeTreeOptions options;
        options.depth = depth;
        options.leastPixels = 1e-3;
        options.mostStray = 5;
        const ChromeTree tree = treeOf(bodies, before, {0, 0, 0}, options);
        ASSERT_EQ(tree.status, ChromeTreeStatus::ok);
        EXPECT_EQ(tree.passes(), 2u * static_cast<std::uint32_t>(depth - 1));
        EXPECT_EQ(tree.counters.tooDeep, depth > 1 ? 2u : 0u);
        EXPECT_EQ(tree.counters.deepest, depth > 1 ? static_cast<std::uint32_t>(depth) : 0u);
        for (std::size_t n = 0; n < tree.nodes.size(); ++n) {
            const ChromeNode& node = tree.nodes[n];
            if (node.parent == ChromeNode::none) continue;
            ASSERT_LT(node.parent, n);
            EXPECT_EQ(tree.nodes[node.parent].of, node.in);
            EXPECT_EQ(tree.nodes[node.parent].level + 1, node.level);
            // Each is seen smaller than what it is seen in.
            EXPECT_LT(node.pixels, tree.nodes[node.parent].size.x);
        }
    }
}

TEST(ChromeTree, NothingIsPlannedWhereNothingIsSeen) {
    const Ball a({0, 0, 0}, 0.4), hidden({0, 1.2, -0.1}, 0.2), far({30, 0, 0}, 0.4);
    ChromeTreeOptions options;
    options.depth = 3;
    // Behind the ball, as the eye sees it.
    std::vector<ChromeBody> bodies{a.body(), hidden.body()};
    bodies[1].inView = false;
    ChromeTree tree = treeOf(bodies, before, {0, 0, 0}, options);
    EXPECT_EQ(tree.nodes.size(), 0u);
    EXPECT_EQ(tree.counters.unseen, 1u);
    // Out of reach: not even looked at.
    bodies = {a.body(5), far.body(5)};
    tree = treeOf(bodies, before, {0, 0, 0}, options);
    EXPECT_EQ(tree.nodes.size(), 0u);
    EXPECT_EQ(tree.counters.searched, 0u);
    // Nothing in view, nothing at a depth of 1, nothing but one part.
    const Ball beside({0.9, -0.3, 0}, 0.3);
    bodies = {a.body(), beside.body()};
    bodies[0].inView = bodies[1].inView = false;
    EXPECT_EQ(treeOf(bodies, before, {0, 0, 0}, options).counters.searched, 0u);
    bodies = {a.body(), beside.body()};
    EXPECT_GT(treeOf(bodies, before, {0, 0, 0}, options).passes(), 0u);
    options.depth = 1;
    EXPECT_EQ(treeOf(bodies, before, {0, 0, 0}, options).counters.searched, 0u);
    options.depth = 3;
    EXPECT_EQ(treeOf(std::span(bodies).first(1), before, {0, 0, 0}, options).nodes.size(), 0u);
    // Too small to matter: seen, but without a picture.
    options.leastPixels = 1000;
    tree = treeOf(bodies, before, {0, 0, 0}, options);
    EXPECT_EQ(tree.passes(), 0u);
    EXPECT_EQ(tree.counters.tooSmall, 2u);
}

TEST(ChromeTree, TheMostVisiblePicturesHaveRoomFirst) {
    const Ball a({-0.8, 0, 0}, 0.4), b({0.8, 0, 0}, 0.4), c({0, 0.9, 0}, 0.2);
    const std::vector<ChromeBody> bodies{a.body(), b.body(), c.body()};
    ChromeTreeOptions options;
    options.depth = 3;
    options.mostStray = 5;
    options.leastPixels = 1;
    const ChromeTree all = treeOf(bodies, before, {0, 0, 0}, options);
    options.mostPictures = 3;
    const ChromeTree few = treeOf(bodies, before, {0, 0, 0}, options);
    ASSERT_GT(all.passes(), 3u);
    ASSERT_EQ(few.passes(), 3u);
    EXPECT_GT(few.counters.overCap, 0u);
    double least = 1e9, most = 0;
    for (const ChromeNode& n : few.nodes) {
        if (n.look == ChromeLook::picture) least = std::min(least, n.pixels);
        if (n.look == ChromeLook::overCap) most = std::max(most, n.pixels);
    }
    EXPECT_GE(least, most);
}

TEST(ChromeTree, BadSettingsAreRefused) {
    const Ball a({-0.8, 0, 0}, 0.4, 16), b({0.8, 0, 0}, 0.4, 16);
    std::vector<ChromeBody> bodies{a.body(), b.body()};
    const auto refused = [&](auto&& change) {
        ChromeTreeOptions options;
        change(options);
        const ChromeTree tree = treeOf(bodies, before, {0, 0, 0}, options);
        return tree.status == ChromeTreeStatus::badSettings && tree.nodes.empty();
    };
    EXPECT_FALSE(refused([](ChromeTreeOptions&) {}));
    EXPECT_TRUE(refused([](ChromeTreeOptions& o) { o.depth = 0; }));
    EXPECT_TRUE(refused([](ChromeTreeOptions& o) { o.depth = -3; }));
    EXPECT_TRUE(refused([](ChromeTreeOptions& o) { o.depth = 9; }));
    EXPECT_TRUE(refused([](ChromeTreeOptions& o) { o.mostStray = 0; }));
    EXPECT_TRUE(refused([](ChromeTreeOptions& o) { o.texelsPerPixel = NAN; }));
    EXPECT_TRUE(refused([](ChromeTreeOptions& o) { o.mostSlices = 0; }));
    bodies[1].points = {};
    EXPECT_TRUE(refused([](ChromeTreeOptions&) {}));
}

TEST(ChromeTree, AFlatPieceMirrorsTheEye) {
    // A ball of a hundred metres is a floor, but that 1/s' = 1/s + 2/(100 m cosine) brings the eye's image
    // from 2.5 m below it to 2.3 in the plane of incidence and 2.4 across.
    const Ball floor({0, 0, -100}, 100, 256);
    const Ball seen({0.3, 0.2, 0.8}, 0.25);
    const BounceEye found = bounceEye(floor.map(), {0, -2, 1.5}, seen.points[0]);
    ASSERT_GE(found.seen.size(), 10u);
    EXPECT_LT(glm::distance(found.eye, glm::dvec3(0, -2, -1.5)), 0.15);
    EXPECT_LT(found.stray, 4e-3);
}

/// The oracle: rays from the eye over one ball to the other. What lies on the ray beyond must be found in
/// the node's picture where the ball's point takes its look.
TEST(ChromeTree, PicturesShowWhatRaysOfTwoBouncesMeet) {
    std::mt19937_64 random(7);
    const auto unit = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
    int pictures = 0, rays = 0;
    double worst = 0;
    for (int scene = 0; scene < 40; ++scene) {
        const double ra = 0.2 + 0.6 * unit(), rb = 0.1 + 0.5 * unit();
        const Ball a({0, 0, 0}, ra, 32);
        const double gap = ra + rb + 0.1 + 1.5 * unit(), turn = -2.6 + 5.2 * unit();
        const Ball b({gap * std::sin(turn), -gap * std::cos(turn), 0.4 * (unit() - 0.5)}, rb, 32);
        const glm::dvec3 eye(0.5 * (unit() - 0.5), -4 - 4 * unit(), unit() - 0.5);
        std::vector<ChromeBody> bodies{a.body(), b.body()};
        bodies[1].inView = false;
        ChromeTreeOptions options;
        options.mostStray = 2;
        options.mostSlices = 1;
        const ChromeTree tree = treeOf(bodies, eye, {0, 0, 0}, options, {1920, 1080});
        for (const ChromeNode& node : tree.nodes) {
            if (node.look != ChromeLook::picture) continue;
            ++pictures;
            EXPECT_LE(node.stray, options.mostStray);
            const double perRadian = 0.5 * node.size.x * node.view.clipFromView[0][0];
            for (int k = 0; k < 2000; ++k) {
                const glm::dvec3 towards = ra * glm::dvec3(2 * unit() - 1, -unit(), 2 * unit() - 1) - eye;
                const std::optional<Hit> first = bounce(a, eye, glm::normalize(towards));
                if (!first) continue;
                const std::optional<Hit> second = bounce(b, first->point, first->onward);
                if (!second) continue;
                const auto placeOf = [&](double t) {
                    const glm::dvec3 vertex = second->point + t * second->onward;
                    ReflectionPoint at;
                    findReflectionPoints(b.map(), node.eye, std::span(&vertex, 1), std::span(&at, 1));
                    EXPECT_EQ(at.status, ReflectionStatus::found);
                    const glm::dvec4 clip = node.view.clip(at.point);
                    return glm::dvec2(clip) / clip.w * 0.5 * static_cast<double>(node.size.x);
                };
                // The node's bound is for what is not seen at a grazing angle.
                const glm::dvec3 n = (second->point - b.centre) / rb;
                if (glm::dot(n, second->onward) < 0.5) continue;
                // Where the ball's point takes its look, and where what it shows is.
                const glm::dvec2 taken = placeOf(node.middle);
                for (const double t : {rb, 3 * rb, 1000.0}) {
                    const double off = glm::distance(taken, placeOf(t));
                    // Points between the 48 that were asked lie farther out by up to a quarter.
                    EXPECT_LE(off, 1.25 * node.stray + 0.1) << "scene " << scene << " t " << t;
                    worst = std::max(worst, off);
                }
                ++rays;
            }
            EXPECT_GT(perRadian, 0);
        }
    }
    EXPECT_GE(pictures, 15);
    EXPECT_GE(rays, 300);
    RecordProperty("worst_texels", std::to_string(worst));
}

TEST(ChromeTree, DegeneratePlacesHaveAnAnswer) {
    const Ball a({0, 0, 0}, 0.5), touching({0.9, 0, 0}, 0.4), around({0, 0, 0}, 3), same({0, 0, 0}, 0.5);
    ChromeTreeOptions options;
    options.depth = 4;
    for (const Ball* other : {&touching, &around, &same})
        for (const glm::dvec3& eye :
             {before, glm::dvec3(0.5, 0, 0), glm::dvec3(0), glm::dvec3(0.9, 0, 0), glm::dvec3(1e6, 0, 0)}) {
            const std::vector<ChromeBody> bodies{a.body(), other->body()};
            const ChromeTree tree = treeOf(bodies, eye, {0.1, 0.2, 0.3}, options);
            ASSERT_EQ(tree.status, ChromeTreeStatus::ok);
            EXPECT_LE(tree.passes(), options.mostPictures);
            for (const ChromeNode& n : tree.nodes) {
                EXPECT_TRUE(std::isfinite(n.eye.x + n.eye.y + n.eye.z));
                EXPECT_TRUE(std::isfinite(n.pixels) && std::isfinite(n.stray));
                EXPECT_EQ(n.look == ChromeLook::picture, n.size.x > 0);
            }
        }
}

}  // namespace
}  // namespace reflection
