#include "reflection/local_map/LocalMapBuilder.h"

#include <gtest/gtest.h>

#include "tests/reflection/local_map/AnalyticScene.h"

namespace reflection {
namespace {

/// The street of AnalyticScene.h as a heightfield whose cells do not meet the walls: they stand up to half a
/// cell too far out or in.
GridTracer streetTracer() {
    city::Heightfield field(60, 240, 1, {-30.5, -120.5});
    for (int j = 0; j < 240; ++j)
        for (int i = 0; i < 60; ++i) {
            const double x = -30.5 + i + 0.5;
            field.set(i, j, x < -8 || x > 9 ? 14.0f : 0.0f);
        }
    return GridTracer(field);
}

struct Built {
    double wrong = 0;  ///< share of texels farther than 0.05 from the truth's colour, of 0.1 to 1.1
    std::uint32_t rays = 0;
    bool sound = true;
};

Built build(LocalMapMethod method, const GridTracer& tracer, std::span<const Candidate> candidates,
            const glm::dvec3& centre, int n, RefineCriterion criterion = RefineCriterion::planarity) {
    LocalMapRequest request;
    request.method = method;
    request.centre = centre;
    request.faceSize = n;
    request.candidates = candidates;
    request.mesh.criterion = criterion;
    request.streetDirection = {0, 1, 0};
    LocalMap map;
    map.resize(n);
    for (auto* plane : {&map.red, &map.green, &map.blue, &map.depth})
        std::fill(plane->begin(), plane->end(), std::numeric_limits<float>::quiet_NaN());
    LocalMapBuilder builder;
    Built built;
    for (int face = 0; face < 6; ++face) {
        built.rays += builder.buildFace(tracer, request, face, map);
        for (int i = 0; i < n * n; ++i) {
            const std::size_t at = map.faceOffset(face) + static_cast<std::size_t>(i);
            const glm::dvec3 got(map.red[at], map.green[at], map.blue[at]);
            const SceneHit hit =
                streetScene(centre, glm::dvec3(cubeDirection(face, glm::vec2(i % n, i / n) + 0.5f, n)));
            // A texel left out stays NaN.
            built.sound = built.sound && map.depth[at] > 0 && got.r >= 0 && got.g >= 0 && got.b >= 0;
            built.wrong += glm::length(got - hit.colour) > 0.05 ? 1.0 / (6 * n * n) : 0;
        }
    }
    return built;
}

TEST(LocalMapBuilderTest, everyMethodFillsEveryTexelAndOursIsWrongAtSilhouettesAlone) {
    const GridTracer tracer = streetTracer();
    std::vector<PackedReferenceMap> maps;
    for (const glm::dvec3& p : {glm::dvec3(0, 2, 2.5), glm::dvec3(2, -9, 2.5), glm::dvec3(-2, 14, 2.5)})
        maps.push_back(mapOf(streetScene, p, 256));
    const glm::dvec3 centre(1.8, -3, 1.1);
    std::vector<Candidate> candidates;
    for (const auto& m : maps) candidates.push_back({&m, glm::vec3(m.position() - centre)});
    for (const int n : {8, 33, 128}) {
        const Built blend = build(LocalMapMethod::blend, tracer, candidates, centre, n);
        const Built box = build(LocalMapMethod::box, tracer, candidates, centre, n);
        const Built paper =
            build(LocalMapMethod::memPaper, tracer, candidates, centre, n, RefineCriterion::depthRatio);
        const Built ours = build(LocalMapMethod::mem, tracer, candidates, centre, n);
        EXPECT_TRUE(blend.sound && box.sound && paper.sound && ours.sound) << n;
        EXPECT_EQ(blend.rays + box.rays, 0u);
        EXPECT_GT(paper.rays, 0u);
        EXPECT_GT(ours.rays, 0u);
        EXPECT_LT(paper.wrong, blend.wrong) << n;
        // On a face of 8 texels a third of them are silhouettes: every method is a smear there.
        if (n > 8) {
            EXPECT_LT(ours.wrong, paper.wrong) << n;
        }
        // The street is a box, so `box` is right everywhere but at silhouettes; so must ours be, without
        // knowing of any box. A silhouette is a line of about 5 n of the 6 n^2 texels.
        EXPECT_LT(ours.wrong, box.wrong + 1.0 / n) << n;
        EXPECT_LT(ours.wrong, 3.0 / n) << n;
    }
}

TEST(LocalMapBuilderTest, oneCandidateIsEnoughAndNoneIsBlackSky) {
    const GridTracer tracer = streetTracer();
    const glm::dvec3 centre(1.8, -3, 1.1), at(0, -2, 2.5);
    const PackedReferenceMap reference = mapOf(streetScene, at, 64);
    const Candidate one{&reference, glm::vec3(at - centre)};
    const Candidate same{&reference, glm::vec3(0)};
    for (const auto method :
         {LocalMapMethod::blend, LocalMapMethod::box, LocalMapMethod::memPaper, LocalMapMethod::mem}) {
        EXPECT_TRUE(build(method, tracer, std::span(&one, 1), centre, 16).sound);
        EXPECT_TRUE(build(method, tracer, std::span(&same, 1), at, 16).sound);
        LocalMapRequest request;
        request.method = method;
        request.faceSize = 4;
        LocalMap map;
        map.resize(4);
        LocalMapBuilder builder;
        for (int face = 0; face < 6; ++face) EXPECT_EQ(builder.buildFace(tracer, request, face, map), 0u);
        for (std::size_t i = 0; i < map.depth.size(); ++i) {
            EXPECT_EQ(map.red[i] + map.green[i] + map.blue[i], 0.0f);
            EXPECT_TRUE(std::isinf(map.depth[i]));
        }
    }
}

TEST(LocalMapBuilderTest, streetBoxIsTheStreet) {
    const PackedReferenceMap reference = mapOf(streetScene, {0, 0, 2.5}, 64);
    const StreetBox box = streetBoxOf(reference, {0, 1, 0});
    // Left of north is west.
    EXPECT_NEAR(box.left, 8, 0.4f);
    EXPECT_NEAR(box.right, 9, 0.4f);
    EXPECT_NEAR(box.below, 2.5f, 0.1f);
    EXPECT_GT(box.ahead, 15);
    EXPECT_GT(box.behind, 15);
}

}  // namespace
}  // namespace reflection
