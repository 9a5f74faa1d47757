#include "reflection/local_map/ReferenceLookup.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tests/reflection/EveryInstructionSet.h"
#include "tests/reflection/local_map/AnalyticScene.h"
#include "tests/reflection/tracing/SeededRandom.h"

namespace reflection {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

/// What packing may do to a colour: a step of 5 mantissa bits by the dither, shares to 8 bits.
constexpr double packedColourError = 1.0 / 32 + 1.0 / 255;
/// Nearness: half a step of 7 mantissa bits.
constexpr double packedDepthError = 1.0 / 256;

/// The slow way to what a level holds in a direction: bilinear nearness and brightness, the nearest texel's
/// chroma.
struct SlowProbe {
    double nearness = 0;
    glm::dvec3 colour{0};
};

SlowProbe slowProbe(const PackedReferenceMap& map, int localFaceSize, const glm::dvec3& to) {
    const auto& level = map.levelFor(localFaceSize);
    const int n = level.faceSize();
    const CubePoint p = cubePoint(glm::vec3(to));
    const auto nearest = [n](double u) { return std::clamp(static_cast<int>(std::floor(u)), 0, n - 1); };
    const double u = (static_cast<double>(p.st.x) * 0.5 + 0.5) * n,
                 v = (static_cast<double>(p.st.y) * 0.5 + 0.5) * n;
    const int x = static_cast<int>(std::floor(u - 0.5)), y = static_cast<int>(std::floor(v - 0.5));
    const double fx = u - 0.5 - x, fy = v - 0.5 - y;
    SlowProbe result;
    double sum = 0;
    for (int k = 0; k < 4; ++k) {
        const double w = (k & 1 ? fx : 1 - fx) * (k & 2 ? fy : 1 - fy);
        const glm::dvec3 c(level.colourAt(p.face, x + (k & 1), y + (k >> 1)));
        sum += w * (c.r + c.g + c.b);
        result.nearness += w * static_cast<double>(level.nearnessAt(p.face, x + (k & 1), y + (k >> 1)));
    }
    const glm::dvec3 chroma(level.colourAt(p.face, nearest(u), nearest(v)));
    result.colour = chroma * (sum / (chroma.r + chroma.g + chroma.b));
    return result;
}

LocalMap emptyMap(int n) {
    LocalMap map;
    map.resize(n);
    return map;
}

glm::dvec3 colourOf(const LocalMap& map, std::size_t i) {
    return {map.red[i], map.green[i], map.blue[i]};
}

TEST(ReferenceLookupTest, oneLookupReadsWhatTheSlowWayReads) {
    const glm::dvec3 centre(0.4, 1.1, 0.9), other(-1.2, 2.5, 1.6);
    const PackedReferenceMap reference = mapOf(roomScene, other, 64);
    const Candidate candidate{&reference, glm::vec3(other - centre)};
    LookupOptions options;
    options.lookups = 1;
    onEveryInstructionSet([&] {
        for (const int n : {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 128}) {
            LocalMap map = emptyMap(n);
            for (int face = 0; face < 6; ++face) {
                std::vector<float> start;
                for (int i = 0; i < n * n; ++i) start.push_back(0.1f + 0.05f * static_cast<float>(i % 7));
                // Beyond the end lies nothing that may be read or written.
                start.shrink_to_fit();
                lookUpRefined(face, start, std::span(&candidate, 1), options, map);
                for (int i = 0; i < n * n; ++i) {
                    const std::size_t at = map.faceOffset(face) + static_cast<std::size_t>(i);
                    const glm::dvec3 d(cubeDirection(face, glm::vec2(i % n, i / n) + 0.5f, n));
                    const double t = 1 / static_cast<double>(start[static_cast<std::size_t>(i)]);
                    ASSERT_NEAR(map.depth[at], t, 1e-5 * t) << n;
                    const glm::dvec3 to = centre + t * d - other;
                    // A texel's border is a jump in chroma, an edge of the cube one of everything: rounding
                    // decides there.
                    const CubePoint p = cubePoint(glm::vec3(to));
                    const double m = reference.levelFor(n).faceSize();
                    const glm::dvec2 uv = (glm::dvec2(p.st) * 0.5 + 0.5) * m;
                    if (glm::length(uv - glm::round(uv)) < 1e-3 ||
                        std::max(std::abs(p.st.x), std::abs(p.st.y)) > 0.9999f)
                        continue;
                    const glm::dvec3 truth = slowProbe(reference, n, to).colour;
                    ASSERT_LT(glm::length(colourOf(map, at) - truth), 1e-3) << n << ' ' << face << ' ' << i;
                }
            }
        }
    });
}

TEST(ReferenceLookupTest, blendMixesTwoSlowLookups) {
    const glm::dvec3 centre(0.4, 1.1, 0.9), first(-1.2, 2.5, 1.6), second(2, -3, 1);
    const PackedReferenceMap a = mapOf(roomScene, first, 64), b = mapOf(streetScene, second, 32);
    const Candidate ca{&a, glm::vec3(first - centre)}, cb{&b, glm::vec3(second - centre)};
    SeededRandom random(61);
    onEveryInstructionSet([&] {
        for (int n = 1; n <= 17; ++n) {
            LocalMap map = emptyMap(n);
            std::vector<float> x, y, z, w;
            for (int i = 0; i < n * n; ++i) {
                x.push_back(static_cast<float>(random.between(-20, 20)));
                y.push_back(static_cast<float>(random.between(-20, 20)));
                z.push_back(static_cast<float>(random.between(-20, 20)));
                w.push_back(static_cast<float>(random.below(5)) / 4);
            }
            const int face = n % 6;
            lookUpBlended(face, x, y, z, w, ca, cb, map);
            int wrong = 0;
            for (std::size_t i = 0; i < x.size(); ++i) {
                const glm::dvec3 p(x[i], y[i], z[i]);
                const double weight = w[i];
                const glm::dvec3 truth = slowProbe(a, n, p - glm::dvec3(ca.offset)).colour * weight +
                                         slowProbe(b, n, p - glm::dvec3(cb.offset)).colour * (1 - weight);
                wrong += glm::length(colourOf(map, map.faceOffset(face) + i) - truth) > 1e-3 ? 1 : 0;
            }
            // Points within a float's rounding of a texel's border may take the next one's chroma.
            EXPECT_LE(wrong, n * n / 100) << n;
        }
    });
}

struct Errors {
    int clean = 0, depthWrong = 0, colourWrong = 0;
    double worstDepth = 0, worstColour = 0;
};

/// Builds a local map from starts that are off by up to `disturbance` metres and counts the texels beyond the
/// bounds that follow from the packing and the agreement asked for.
Errors compareWithTruth(const Scene& scene, const glm::dvec3& centre,
                        std::span<const PackedReferenceMap> maps, int n, double disturbance,
                        std::uint64_t seed) {
    SeededRandom random(seed);
    std::vector<Candidate> candidates;
    for (const auto& m : maps) candidates.push_back({&m, glm::vec3(m.position() - centre)});
    LocalMap map = emptyMap(n);
    const LookupOptions options;
    Errors errors;
    for (int face = 0; face < 6; ++face) {
        std::vector<float> start;
        std::vector<SceneHit> truth;
        for (int i = 0; i < n * n; ++i) {
            const glm::dvec3 d(cubeDirection(face, glm::vec2(i % n, i / n) + 0.5f, n));
            truth.push_back(scene(centre, d));
            const double off = random.between(-disturbance, disturbance) / glm::length(d);
            start.push_back(
                static_cast<float>(truth.back().surface < 0 ? 0 : 1 / std::max(0.05, truth.back().t + off)));
        }
        lookUpRefined(face, start, candidates, options, map);
        for (int i = 0; i < n * n; ++i) {
            const SceneHit& hit = truth[static_cast<std::size_t>(i)];
            const std::size_t at = map.faceOffset(face) + static_cast<std::size_t>(i);
            const glm::dvec3 d(cubeDirection(face, glm::vec2(i % n, i / n) + 0.5f, n));
            EXPECT_TRUE(map.depth[at] > 0);
            EXPECT_TRUE(map.red[at] >= 0 && map.green[at] >= 0 && map.blue[at] >= 0);
            if (hit.surface < 0 || hit.t > 60) continue;
            const glm::dvec3 point = centre + hit.t * d;
            bool clean = isClean(scene, centre, point, hit.surface, n, 2);
            double scale = 1;
            for (const auto& m : maps) {
                clean =
                    clean && isClean(scene, m.position(), point, hit.surface, m.levelFor(n).faceSize(), 5);
                scale = std::max(scale, glm::distance(m.position(), point) / glm::distance(centre, point));
            }
            if (!clean) continue;
            ++errors.clean;
            // q = m / M - 1 is known within the packing's error; a hit is taken where |q| < agreement. Its
            // share of the depth is that times the ratio of the two centres' distances from the surface (see
            // ReferenceLookup.h), at most `scale` on these planes but for the sign of the offset; a border
            // texel is its neighbour's nearest, half a texel off.
            const double relative = std::abs(map.depth[at] / hit.t - 1);
            errors.worstDepth = std::max(errors.worstDepth, relative);
            errors.depthWrong +=
                relative > 2 * scale * (static_cast<double>(options.agreement) + packedDepthError) ? 1 : 0;
            const double colour = glm::length(colourOf(map, at) / hit.colour - 1.0) / std::sqrt(3.0);
            errors.worstColour = std::max(errors.worstColour, colour);
            // Brightness by the place: 2.5 % a metre, the place off by a few percent of its distance.
            const double place = 0.025 * 0.02 * scale * hit.t * glm::length(d);
            errors.colourWrong += colour > packedColourError + place + 0.01 ? 1 : 0;
        }
    }
    return errors;
}

TEST(ReferenceLookupTest, exactStartsGiveTheTrueColours) {
    std::vector<PackedReferenceMap> maps;
    for (const glm::dvec3& p : {glm::dvec3(0, 2, 2.5), glm::dvec3(2, -9, 2.5), glm::dvec3(-2, 14, 2.5)})
        maps.push_back(mapOf(streetScene, p, 256));
    for (std::size_t count = 1; count <= maps.size(); ++count) {
        const Errors e =
            compareWithTruth(streetScene, {1.3, 0.5, 1.1}, std::span(maps).first(count), 64, 0, 71);
        EXPECT_GT(e.clean, 8000);
        EXPECT_LE(e.depthWrong, e.clean / 500) << e.worstDepth;
        EXPECT_LE(e.colourWrong, e.clean / 200) << e.worstColour;
    }
}

TEST(ReferenceLookupTest, disturbedStartsComeBackToTheSurface) {
    std::vector<PackedReferenceMap> maps;
    for (const glm::dvec3& p : {glm::dvec3(0, 2, 2.5), glm::dvec3(2, -9, 2.5), glm::dvec3(-2, 14, 2.5)})
        maps.push_back(mapOf(streetScene, p, 256));
    onEveryInstructionSet([&] {
        for (std::size_t count = 1; count <= maps.size(); ++count)
            for (const double disturbance : {0.2, 1.0}) {
                const Errors e = compareWithTruth(streetScene, {1.3, 0.5, 1.1}, std::span(maps).first(count),
                                                  64, disturbance, 72);
                EXPECT_GT(e.clean, 8000);
                EXPECT_LE(e.depthWrong, e.clean / 100) << count << ' ' << disturbance << ' ' << e.worstDepth;
                EXPECT_LE(e.colourWrong, e.clean / 100)
                    << count << ' ' << disturbance << ' ' << e.worstColour;
            }
    });
}

TEST(ReferenceLookupTest, planesAreMetAtAllAnglesDownToThreeDegrees) {
    SeededRandom random(73);
    long asked = 0, wrong = 0;
    for (int k = 0; k < 24; ++k) {
        const double z = random.between(-1, 1), angle = random.between(0, 6.2831853),
                     r = std::sqrt(1 - z * z);
        const glm::dvec3 normal = k < 3 ? glm::dvec3(k == 0, k == 1, k == 2)
                                        : glm::dvec3(r * std::cos(angle), r * std::sin(angle), z);
        const double c = random.between(1, 4);
        const Scene plane = [&](const glm::dvec3& from, const glm::dvec3& d) {
            SceneHit hit;
            const double facing = glm::dot(normal, d), t = (c - glm::dot(normal, from)) / facing;
            hit.colour = glm::dvec3(0.5);
            if (facing > 0 && t > 0) {
                hit.t = t;
                hit.surface = 0;
            }
            return hit;
        };
        const glm::dvec3 map(random.between(-2, 2), random.between(-2, 2), random.between(-2, 2));
        if (c - glm::dot(normal, map) < 0.5) continue;
        const PackedReferenceMap reference = mapOf(plane, map, 256);
        const Candidate candidate{&reference, glm::vec3(map)};
        const int n = 48;
        LocalMap out = emptyMap(n);
        for (int face = 0; face < 6; ++face) {
            std::vector<float> start;
            for (int i = 0; i < n * n; ++i) {
                const glm::dvec3 d(cubeDirection(face, glm::vec2(i % n, i / n) + 0.5f, n));
                const double t = plane(glm::dvec3(0), d).t;
                start.push_back(
                    std::isinf(t)
                        ? 0.0f
                        : static_cast<float>(1 / std::max(0.05, t + random.between(-1, 1) / glm::length(d))));
            }
            lookUpRefined(face, start, std::span(&candidate, 1), {}, out);
            for (int i = 0; i < n * n; ++i) {
                const glm::dvec3 d(cubeDirection(face, glm::vec2(i % n, i / n) + 0.5f, n));
                const SceneHit hit = plane(glm::dvec3(0), d);
                const double sine3 = 0.0523;
                if (hit.surface < 0 || glm::dot(normal, d) < sine3 * glm::length(d)) continue;
                const glm::dvec3 seen = hit.t * d - map;
                if (glm::dot(normal, seen) < sine3 * glm::length(seen)) continue;
                ++asked;
                // The error of q, agreement and packing, times the ratio of the distances from the plane.
                const double bound =
                    (0.01 + 2 * packedDepthError) * std::max(1.0, (c - glm::dot(normal, map)) / c);
                const double got = out.depth[out.faceOffset(face) + static_cast<std::size_t>(i)];
                wrong += std::abs(got / hit.t - 1) > bound ? 1 : 0;
            }
        }
    }
    EXPECT_GT(asked, 40000);
    // Along the cube's edges a bordering texel stands half a texel off.
    EXPECT_LE(wrong, asked / 200);
}

TEST(ReferenceLookupTest, degenerateStartsAndOffsetsGiveNoNaN) {
    const PackedReferenceMap room = mapOf(roomScene, {0, 0, 1}, 32),
                             street = mapOf(streetScene, {1, 1, 2}, 32);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const std::vector<float> values{0,      -0.0f, nan,   -nan, infinity, -infinity, -1,
                                    1e-30f, 1e30f, 3e38f, 1000, 0.5f,     1e-4f};
    SeededRandom random(75);
    onEveryInstructionSet([&] {
        for (int k = 0; k < 60; ++k) {
            const int n = 1 + random.below(17);
            std::vector<float> start;
            for (int i = 0; i < n * n; ++i)
                start.push_back(
                    values[static_cast<std::size_t>(random.below(static_cast<int>(values.size())))]);
            std::vector<Candidate> candidates;
            for (int i = random.below(20); i >= 0; --i)
                candidates.push_back({random.below(2) ? &room : &street,
                                      random.below(2)
                                          ? glm::vec3(0)
                                          : glm::vec3(random.between(-3, 3), random.between(-3, 3), 0)});
            LookupOptions options;
            options.lookups = random.below(10);
            LocalMap map = emptyMap(n);
            const int face = random.below(6);
            lookUpRefined(face, start, candidates, options, map);
            for (int i = 0; i < n * n; ++i) {
                const std::size_t at = map.faceOffset(face) + static_cast<std::size_t>(i);
                ASSERT_FALSE(std::isnan(map.depth[at]));
                ASSERT_GE(map.depth[at], 0);
                for (const float c : {map.red[at], map.green[at], map.blue[at]})
                    ASSERT_TRUE(std::isfinite(c) && c >= 0 && c <= 8.1f);
            }
        }
    });
}

TEST(ReferenceLookupTest, skyStaysSkyAndCoincidentCentresReadStraight) {
    const glm::dvec3 centre(1, 1, 2);
    const PackedReferenceMap street = mapOf(streetScene, centre, 64);
    const Candidate same{&street, glm::vec3(0)};
    const int n = 32;
    LocalMap map = emptyMap(n);
    int asked = 0;
    for (int face = 0; face < 6; ++face) {
        // Any start will do where the map stands in the local map's centre.
        const std::vector<float> start(static_cast<std::size_t>(n * n), face % 2 ? 0.0f : 0.1f);
        lookUpRefined(face, start, std::span(&same, 1), {}, map);
        for (int i = 0; i < n * n; ++i) {
            const glm::dvec3 d(cubeDirection(face, glm::vec2(i % n, i / n) + 0.5f, n));
            const SceneHit hit = streetScene(centre, d);
            if (!isClean(streetScene, centre, centre + d, hit.surface, 64, 6)) continue;
            const std::size_t at = map.faceOffset(face) + static_cast<std::size_t>(i);
            if (hit.surface < 0 && face % 2) {
                EXPECT_EQ(map.depth[at], infinity);
            }
            if (hit.t > 60 && hit.surface >= 0) continue;
            ++asked;
            // Two texels of 64 make one of 32: between their centres, a place's brightness as far as a texel
            // of the wall.
            EXPECT_LT(glm::length(colourOf(map, at) / hit.colour - 1.0) / std::sqrt(3.0),
                      packedColourError + 0.01)
                << face << ' ' << i;
        }
    }
    EXPECT_GT(asked, 3000);
}

TEST(ReferenceLookupTest, aSurfaceIsNoSkyUpToHalfTheDistanceThatStandsForIt) {
    const int n = 16;
    for (const double distance : {100.0, 1000.0, 3500.0, 5000.0}) {
        const PackedReferenceMap around = mapOf(
            [&](const glm::dvec3&, const glm::dvec3& d) {
                return SceneHit{distance / glm::length(d), 0, glm::dvec3(0.5)};
            },
            glm::dvec3(0), 32);
        const Candidate same{&around, glm::vec3(0)};
        LocalMap map = emptyMap(n);
        for (int face = 0; face < 6; ++face) {
            const std::vector<float> start(static_cast<std::size_t>(n * n),
                                           1.0f / static_cast<float>(distance));
            lookUpRefined(face, start, std::span(&same, 1), {}, map);
            for (int i = 0; i < n * n; ++i) {
                const double length =
                    static_cast<double>(glm::length(cubeDirection(face, glm::vec2(i % n, i / n) + 0.5f, n)));
                const float depth = map.depth[map.faceOffset(face) + static_cast<std::size_t>(i)];
                // The start is the ray's own parameter: on a cube's face up to sqrt(3) times as far.
                if (distance / length < 0.45 * static_cast<double>(PackedReferenceMap::skyDepth) &&
                    distance < 0.45 * static_cast<double>(PackedReferenceMap::skyDepth)) {
                    EXPECT_TRUE(std::isfinite(depth)) << distance << " m, face " << face;
                }
                if (distance / length > 0.55 * static_cast<double>(PackedReferenceMap::skyDepth)) {
                    EXPECT_EQ(depth, infinity) << distance << " m, face " << face;
                }
            }
        }
    }
}

TEST(ReferenceLookupTest, aStartInTheSkyComesBackToTheMapsSurface) {
    // What a heightfield lacks (a lamp post, a wire), or a mesh has smeared over a silhouette, starts 8 km
    // off.
    const glm::dvec3 centre(1.3, 0.5, 1.1);
    for (const glm::dvec3& offset : {glm::dvec3(0), glm::dvec3(-0.7, 1, 0.8), glm::dvec3(1, -5, 1.4)}) {
        const PackedReferenceMap street = mapOf(streetScene, centre + offset, 128);
        const Candidate candidate{&street, glm::vec3(offset)};
        const int n = 32;
        LocalMap map = emptyMap(n);
        int asked = 0, wrong = 0;
        for (int face = 0; face < 6; ++face) {
            const std::vector<float> start(static_cast<std::size_t>(n * n), 0.0f);
            lookUpRefined(face, start, std::span(&candidate, 1), {}, map);
            for (int i = 0; i < n * n; ++i) {
                const glm::dvec3 d(cubeDirection(face, glm::vec2(i % n, i / n) + 0.5f, n));
                const SceneHit hit = streetScene(centre, d);
                // The map must show one surface from the direction of the ray to that of the hit.
                if (hit.surface < 0 || hit.t > 30) continue;
                bool clean = true;
                for (const double t : {hit.t, 1.5 * hit.t, 3 * hit.t, 10 * hit.t, 8192.0})
                    clean =
                        clean && isClean(streetScene, centre + offset, centre + t * d, hit.surface, 64, 3);
                if (!clean) continue;
                ++asked;
                const double got = map.depth[map.faceOffset(face) + static_cast<std::size_t>(i)];
                wrong += std::abs(got / hit.t - 1) > 2 * (0.01 + packedDepthError) ? 1 : 0;
            }
        }
        EXPECT_GT(asked, 1000);
        // Three lookups more do not always suffice for a map as far away as the walls.
        EXPECT_LE(wrong, glm::length(offset) > 4 ? asked / 8 : asked / 50) << offset.y;
    }
}

TEST(ReferenceLookupTest, instructionSetsAgreeWithinRounding) {
    // No agreement asked for and one candidate: every texel makes every step, whatever its neighbours in the
    // vector do.
    const glm::dvec3 centre(0.4, 1.1, 0.9), other(-1.2, 2.5, 1.6);
    const PackedReferenceMap reference = mapOf(roomScene, other, 64);
    const Candidate candidate{&reference, glm::vec3(other - centre)};
    LookupOptions options;
    options.agreement = 0;
    for (const int n : {3, 16, 33}) {
        SeededRandom random(76);
        std::vector<float> start;
        for (int i = 0; i < n * n; ++i) {
            const glm::dvec3 d(cubeDirection(1, glm::vec2(i % n, i / n) + 0.5f, n));
            start.push_back(static_cast<float>(1 / (roomScene(centre, d).t * random.between(0.8, 1.25))));
        }
        LocalMap best = emptyMap(n);
        lookUpRefined(1, start, std::span(&candidate, 1), options, best);
        onEveryInstructionSet([&] {
            LocalMap map = emptyMap(n);
            lookUpRefined(1, start, std::span(&candidate, 1), options, map);
            int differ = 0;
            for (int i = 0; i < n * n; ++i) {
                const std::size_t at = map.faceOffset(1) + static_cast<std::size_t>(i);
                const bool depth = std::abs(map.depth[at] / best.depth[at] - 1) < 1e-3f;
                const bool colour = glm::length(colourOf(map, at) / colourOf(best, at) - 1.0) < 1e-2;
                differ += depth && colour ? 0 : 1;
            }
            // Of two lookups that agree equally well rounding may prefer the other; in a room's corner they
            // lie apart.
            EXPECT_LE(differ, n * n / 100) << n;
        });
    }
}

TEST(ReferenceLookupTest, storedDistanceIsTheNearestTexels) {
    const glm::dvec3 centre(1, 0, 2);
    const PackedReferenceMap street = mapOf(streetScene, centre, 128);
    const glm::vec3 offset(0.5f, -1, 0.25f);
    const Candidate candidate{&street, offset};
    SeededRandom random(77);
    for (int k = 0; k < 5000; ++k) {
        const glm::vec3 to(random.between(-9, 9), random.between(-9, 9), random.between(-9, 9));
        const CubePoint p = cubePoint(to + offset - offset);
        const auto texel = [](float st) {
            return std::clamp(static_cast<int>(std::floor((static_cast<double>(st) * 0.5 + 0.5) * 128)), 0,
                              127);
        };
        const float expected = street.levels().front().distanceAt(p.face, texel(p.st.x), texel(p.st.y));
        EXPECT_EQ(storedDistance(candidate, to + offset), expected);
    }
    const float atItself = storedDistance(candidate, offset);
    EXPECT_FALSE(std::isnan(atItself));
    EXPECT_FALSE(std::isnan(storedDistance(candidate, glm::vec3(std::numeric_limits<float>::quiet_NaN()))));
}

}  // namespace
}  // namespace reflection
