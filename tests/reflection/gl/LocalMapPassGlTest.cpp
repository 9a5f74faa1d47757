// Local maps made by the GPU against those that the processor makes from the same reference maps.
#include "reflection/gl/LocalMapPass.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "app/display/OffscreenContext.h"
#include "reflection/gl/DebugOutput.h"
#include "reflection/gl/ReferenceMapBuffer.h"
#include "reflection/local_map/PackedMips.h"
#include "reflection/truth/ImageError.h"
#include "tests/app/render/WritePng.h"
#include "tests/reflection/local_map/AnalyticScene.h"
#include "tests/reflection/tracing/SeededRandom.h"

namespace reflection {
namespace {

constexpr std::size_t plenty = std::size_t{1} << 30;

/// The street of AnalyticScene.h in cells that do not meet its walls: starts are up to half a cell off.
GridTracer streetTracer() {
    city::Heightfield field(60, 240, 1, {-30.5, -120.5});
    for (int j = 0; j < 240; ++j)
        for (int i = 0; i < 60; ++i) {
            const double x = -30.5 + i + 0.5;
            field.set(i, j, x < -8 || x > 9 ? 14.0f : 0.0f);
        }
    return GridTracer(field);
}

std::vector<glm::vec3> unpacked(const PackedMips& mips, int level) {
    const std::size_t from = mips.levelOffset(level), to = mips.levelOffset(level + 1);
    std::vector<glm::vec3> colours;
    for (std::size_t i = from; i < to; ++i) {
        glm::vec3 c;
        unpackTexel(mips.texels[i], c.r, c.g, c.b);
        colours.push_back(c);
    }
    return colours;
}

/// Six faces below each other, for a person to look at.
void writeFaces(const std::string& name, const std::vector<glm::vec3>& colours, int side) {
    app::Image8 image;
    image.size = {side, 6 * side};
    for (const glm::vec3& c : colours) {
        for (int k = 0; k < 3; ++k)
            image.rgba.push_back(
                static_cast<std::uint8_t>(255 * std::sqrt(std::clamp(c[k] / 2, 0.0f, 1.0f))));
        image.rgba.push_back(255);
    }
    app::test::writePng(name, image);
}

struct Difference {
    double psnr = 0;       ///< dB, of radiance with peak 2, over all faces of level 0
    double beyond = 0;     ///< share of level 0's texels that differ by more than `tolerance` of the brighter
    double elsewhere = 0;  ///< share of level 0's texels whose distances differ by more than a hundredth
    double beyondCoarse = 0;  ///< the same for the other levels together
};

Difference compare(const PackedMips& actual, const PackedMips& expected, double tolerance) {
    Difference result;
    std::size_t coarse = 0;
    for (int level = 0; level < expected.levelCount(); ++level) {
        const std::vector<glm::vec3> a = unpacked(actual, level), b = unpacked(expected, level);
        std::size_t beyond = 0;
        for (std::size_t i = 0; i < a.size(); ++i) {
            const float scale = std::max({a[i].r, a[i].g, a[i].b, b[i].r, b[i].g, b[i].b});
            const glm::vec3 off = glm::abs(a[i] - b[i]);
            beyond += std::max({off.r, off.g, off.b}) > tolerance * static_cast<double>(scale) ? 1 : 0;
        }
        if (level == 0) {
            std::vector<glm::vec3> halfA, halfB;
            for (std::size_t i = 0; i < a.size(); ++i) {
                halfA.push_back(0.5f * a[i]);
                halfB.push_back(0.5f * b[i]);
            }
            const int n = expected.faceSize;
            result.psnr = psnr({n, 6 * n, halfA}, {n, 6 * n, halfB});
            result.beyond = static_cast<double>(beyond) / static_cast<double>(a.size());
        } else {
            coarse += a.size();
            result.beyondCoarse += static_cast<double>(beyond);
        }
    }
    std::size_t elsewhere = 0;
    for (std::size_t i = 0; i < expected.nearness.size(); ++i) {
        const float a = unpackNearness(actual.nearness[i]), b = unpackNearness(expected.nearness[i]);
        elsewhere += std::abs(a - b) > 0.01f * std::max(a, b) ? 1 : 0;
    }
    result.elsewhere = static_cast<double>(elsewhere) / static_cast<double>(expected.nearness.size());
    if (coarse > 0) result.beyondCoarse /= static_cast<double>(coarse);
    return result;
}

class LocalMapPassGlTest : public testing::Test {
  public:
    ~LocalMapPassGlTest() override { EXPECT_THAT(debug_.errors(), testing::IsEmpty()); }

  protected:
    LocalMapPassGlTest() {
        atlas_.keepNearness();
        for (const glm::dvec3& p : {glm::dvec3(0, 2, 2.5), glm::dvec3(2, -9, 2.5), glm::dvec3(-2, 14, 2.5)})
            maps_.push_back(mapOf(streetScene, p, 256));
    }

    std::vector<Candidate> candidatesAt(const glm::dvec3& centre, std::size_t count) const {
        std::vector<Candidate> candidates;
        for (std::size_t i = 0; i < count; ++i)
            candidates.push_back({&maps_[i], glm::vec3(maps_[i].position() - centre)});
        return candidates;
    }

    static LocalMapRequest requestAt(const glm::dvec3& centre, int faceSize,
                                     std::span<const Candidate> candidates) {
        LocalMapRequest request;
        request.centre = centre;
        request.faceSize = faceSize;
        request.candidates = candidates;
        request.mesh.baseCells = std::max(1, faceSize / 8);
        return request;
    }

    static PackedMips onProcessor(const GridTracer& tracer, const LocalMapRequest& request,
                                  std::span<const MovingObject> objects = {}) {
        LocalMap map;
        map.resize(request.faceSize);
        LocalMapBuilder builder;
        for (int face = 0; face < 6; ++face) {
            builder.buildFace(tracer, request, face, map);
            drawMovingObjects(objects, face, map);
        }
        PackedMips mips;
        packMips(map, mips);
        return mips;
    }

    PackedMips onGpu(LocalMapPass& pass, const GridTracer& tracer, const LocalMapRequest& request,
                     std::span<const MovingObject> objects = {}) {
        LocalMapSlot slot;
        while (localMapFaceSizes[static_cast<std::size_t>(++slot.sizeClass)] != request.faceSize) {
        }
        slot.layer = 1;
        atlas_.reserve(slot.sizeClass, 2);
        const LocalMapJob job{slot, request, objects};
        pass.build(tracer, std::span(&job, 1), atlas_);
        PackedMips mips;
        atlas_.download(slot, mips);
        return mips;
    }

    /// Compares, and writes actual, expected and their difference where they are not alike enough.
    static Difference alike(const std::string& name, const PackedMips& actual, const PackedMips& expected,
                            double tolerance, double least, double share) {
        const Difference d = compare(actual, expected, tolerance);
        EXPECT_GE(d.psnr, least) << name;
        EXPECT_LE(d.beyond, share) << name;
        EXPECT_LE(d.elsewhere, share) << name;
        EXPECT_LE(d.beyondCoarse, 2 * share) << name;
        if (testing::Test::HasFailure()) {
            const std::vector<glm::vec3> a = unpacked(actual, 0), b = unpacked(expected, 0);
            std::vector<glm::vec3> off;
            for (std::size_t i = 0; i < a.size(); ++i) off.push_back(glm::abs(a[i] - b[i]) * 4.0f);
            writeFaces("LocalMapPass_" + name + "_actual", a, actual.faceSize);
            writeFaces("LocalMapPass_" + name + "_expected", b, actual.faceSize);
            writeFaces("LocalMapPass_" + name + "_difference", off, actual.faceSize);
        }
        return d;
    }

    app::OffscreenContext context_;
    gl::DebugOutput debug_;
    LocalMapAtlas atlas_;
    std::vector<PackedReferenceMap> maps_;
    GridTracer tracer_ = streetTracer();
    glm::dvec3 centre_{1.8, -3, 1.1};
};

// A texel of R11F_G11F_B10F: one step of 5 mantissa bits, as two roundings of nearly the same value may
// differ.
constexpr double oneStep = 1.0 / 32;
// Hits found within the agreement (1 % of the distance, on either side of the surface) lie up to 2 % of at
// most 40 m apart, over which the street's brightness changes by 2.5 % a metre; between them packed
// brightness may differ by the step of its dither, 1/32.
constexpr double withinAgreement = oneStep + 1.0 / 32 + 0.02 * 40 * 0.025;

/// Share of texels for which rounding may decide otherwise: the nearest block of chroma, an edge of the cube,
/// an agreement just reached. Two, or one in 500.
double fewTexels(int faceSize) {
    return std::max(2.0 / (6 * faceSize * faceSize), 0.002);
}

TEST_F(LocalMapPassGlTest, oneLookupReadsTheSameTexels) {
    LocalMapPass pass(maps_, plenty);
    const std::vector<Candidate> candidates = candidatesAt(centre_, 1);
    for (const int n : localMapFaceSizes) {
        LocalMapRequest request = requestAt(centre_, n, candidates);
        request.lookup.lookups = 1;
        alike("one_lookup_" + std::to_string(n), onGpu(pass, tracer_, request), onProcessor(tracer_, request),
              oneStep, 50, fewTexels(n));
    }
    // Texels of the finest level, and of the coarser ones that smaller local maps read.
    EXPECT_LT(pass.bytesPerTexel(), 3);
    EXPECT_GT(pass.bytesPerTexel(), 2.5);
    EXPECT_EQ(pass.mapsUploaded(), 1u);
}

TEST_F(LocalMapPassGlTest, whereNoMapAgreesTheBestOneWins) {
    // One lookup from starts up to half a cell off: hardly any agrees, all three are asked.
    LocalMapPass pass(maps_, plenty);
    const std::vector<Candidate> candidates = candidatesAt(centre_, 3);
    for (const int n : localMapFaceSizes) {
        LocalMapRequest request = requestAt(centre_, n, candidates);
        request.lookup.lookups = 1;
        alike("best_" + std::to_string(n), onGpu(pass, tracer_, request), onProcessor(tracer_, request),
              oneStep, 45, fewTexels(n));
    }
}

TEST_F(LocalMapPassGlTest, refinedMapsAgreeWithTheProcessors) {
    LocalMapPass pass(maps_, plenty);
    for (std::size_t count = 1; count <= maps_.size(); ++count) {
        const std::vector<Candidate> candidates = candidatesAt(centre_, count);
        for (const int n : localMapFaceSizes) {
            const LocalMapRequest request = requestAt(centre_, n, candidates);
            // The same steps in the same order: decisions may differ where rounding makes them, here and
            // there a texel (none on llvmpipe, which rounds as the processor does).
            alike("refined_" + std::to_string(count) + "_" + std::to_string(n), onGpu(pass, tracer_, request),
                  onProcessor(tracer_, request), withinAgreement, 45, fewTexels(n));
        }
    }
}

TEST_F(LocalMapPassGlTest, withoutCandidatesAllIsBlack) {
    LocalMapPass pass(maps_, plenty);
    const PackedMips mips = onGpu(pass, tracer_, requestAt(centre_, 16, {}));
    EXPECT_THAT(mips.texels, testing::Each(0u));
    LocalMapPass empty({}, plenty);
    EXPECT_THAT(onGpu(empty, tracer_, requestAt(centre_, 16, {})).texels, testing::Each(0u));
    EXPECT_EQ(pass.build(tracer_, {}, atlas_), 0u);
}

TEST_F(LocalMapPassGlTest, openSkyIsSkyInEveryLevel) {
    // No heightfield in sight, and a map that saw nothing but sky.
    const Scene sky = [](const glm::dvec3&, const glm::dvec3&) {
        SceneHit hit;
        hit.colour = {0.5, 0.7, 1.1};
        return hit;
    };
    const glm::dvec3 high(0, 0, 400);
    const std::vector<PackedReferenceMap> maps{mapOf(sky, high + glm::dvec3(3, 1, 0), 64)};
    const Candidate candidate{&maps[0], glm::vec3(3, 1, 0)};
    LocalMapRequest request = requestAt(high, 32, std::span(&candidate, 1));
    city::Heightfield flat(4, 4, 1, {1000, 1000});
    const GridTracer tracer(flat);
    LocalMapPass pass(maps, plenty);
    const PackedMips actual = onGpu(pass, tracer, request);
    alike("sky", actual, onProcessor(tracer, request), oneStep, 50, 0);
    const std::vector<glm::vec3> coarsest = unpacked(actual, 5);
    for (const glm::vec3& c : coarsest) {
        EXPECT_NEAR(c.r, 0.5, 0.05);
        EXPECT_NEAR(c.b, 1.1, 0.05);
    }
}

TEST_F(LocalMapPassGlTest, aSkyOfItsOwnShowsWhereTheHeightfieldDoes) {
    LocalMapPass pass(maps_, plenty);
    const std::vector<Candidate> candidates = candidatesAt(centre_, 3);
    for (const int n : {128, 32}) {
        LocalMap sky;
        sky.resize(n);
        for (std::size_t i = 0; i < sky.red.size(); ++i) {
            const float shade = 0.5f + static_cast<float>(i % 97) / 97;
            sky.red[i] = shade;
            sky.green[i] = sky.blue[i] = 3 * shade;
        }
        LocalMapRequest request = requestAt(centre_, n, candidates);
        request.lookup.sky = &sky;
        const PackedMips actual = onGpu(pass, tracer_, request);
        alike("own_sky_" + std::to_string(n), actual, onProcessor(tracer_, request), withinAgreement, 45,
              0.002);
        // Another in its place is taken when told.
        for (float& red : sky.red) red *= 2;
        EXPECT_EQ(onGpu(pass, tracer_, request).texels, actual.texels);
        pass.forgetSkies();
        alike("other_sky_" + std::to_string(n), onGpu(pass, tracer_, request), onProcessor(tracer_, request),
              withinAgreement, 45, fewTexels(n));
        pass.forgetSkies();
    }
    LocalMap sky;
    sky.resize(16);
    std::fill(sky.red.begin(), sky.red.end(), 1.0f);
    LocalMapRequest request = requestAt(centre_, 16, {});
    request.lookup.sky = &sky;
    EXPECT_THAT(onGpu(pass, tracer_, request).texels, testing::Each(0u)) << "black without candidates";
}

/// Two boards that face the centre: one near, one behind the street's wall.
std::vector<MovingObject> boards() {
    const auto board = [](const glm::vec3& middle, const glm::vec3& across, const glm::vec3& colour) {
        const glm::vec3 up(0, 0, 0.7f);
        MovingObject object;
        object.positions = {middle - across - up, middle + across - up, middle + across + up,
                            middle - across + up};
        for (int k = 0; k < 4; ++k) object.radiance.push_back(colour * (1 + 0.2f * static_cast<float>(k)));
        object.indices = {0, 1, 2, 0, 2, 3};
        return object;
    };
    return {board({3.5f, 0.5f, 0.2f}, {0, -1.2f, 0}, {1.5f, 0.1f, 0.1f}),
            board({-12, 0, 0}, {0, 3, 0}, {0.1f, 1.5f, 0.1f})};
}

TEST_F(LocalMapPassGlTest, movingObjectsAppearBeforeTheStreetAndHideBehindIt) {
    LocalMapPass pass(maps_, plenty);
    const std::vector<Candidate> candidates = candidatesAt(centre_, 3);
    const std::vector<MovingObject> objects = boards();
    for (const int n : {128, 16}) {
        const LocalMapRequest request = requestAt(centre_, n, candidates);
        const PackedMips actual = onGpu(pass, tracer_, request, objects);
        alike("objects_" + std::to_string(n), actual, onProcessor(tracer_, request, objects), withinAgreement,
              45, fewTexels(n));
        std::size_t red = 0, green = 0;
        for (const glm::vec3& c : unpacked(actual, 0)) {
            red += c.r > 4 * c.g ? 1 : 0;
            green += c.g > 4 * c.r ? 1 : 0;
        }
        // The board subtends 2.4 / 3.5 of a half face across and 1.4 / 3.5 in height.
        EXPECT_NEAR(static_cast<double>(red) / (n * n), 0.25 * 2.4 / 3.5 * 1.4 / 3.5, 3.0 / n);
        EXPECT_EQ(green, 0u);
    }
    // Without candidates there is nothing but them.
    const LocalMapRequest bare = requestAt(centre_, 32, {});
    alike("objects_alone", onGpu(pass, tracer_, bare, objects), onProcessor(tracer_, bare, objects), oneStep,
          50, 0);
}

TEST_F(LocalMapPassGlTest, aFrameOfManySizesAndASmallBudgetGiveTheSameMaps) {
    // Every job alone and with room for all, then all at once, then with room for one map, then for two.
    struct Wanted {
        LocalMapSlot slot;
        glm::dvec3 centre;
        std::vector<Candidate> candidates;
    };
    std::vector<Wanted> wanted;
    SeededRandom random(91);
    std::array<std::int16_t, localMapFaceSizes.size()> layers{};
    for (int i = 0; i < 11; ++i) {
        Wanted w;
        w.slot.sizeClass = static_cast<std::int16_t>(random.below(localMapFaceSizes.size()));
        w.slot.layer = layers[static_cast<std::size_t>(w.slot.sizeClass)]++;
        w.centre = {random.between(-4, 5), random.between(-12, 12), random.between(0.5, 2)};
        const std::size_t map = random.below(maps_.size());
        w.candidates = {{&maps_[map], glm::vec3(maps_[map].position() - w.centre)}};
        wanted.push_back(w);
    }
    for (std::size_t c = 0; c < layers.size(); ++c) atlas_.reserve(static_cast<int>(c), layers[c]);
    std::vector<LocalMapJob> jobs;
    jobs.reserve(wanted.size());
    for (const Wanted& w : wanted)
        jobs.push_back(
            {w.slot,
             requestAt(w.centre, localMapFaceSizes[static_cast<std::size_t>(w.slot.sizeClass)], w.candidates),
             {}});
    const auto results = [&] {
        std::vector<std::vector<std::uint32_t>> all;
        all.reserve(jobs.size());
        for (const LocalMapJob& job : jobs) {
            PackedMips mips;
            atlas_.download(job.slot, mips);
            all.push_back(mips.texels);
        }
        return all;
    };
    LocalMapPass roomy(maps_, plenty);
    std::uint64_t rays = 0;
    for (const LocalMapJob& job : jobs) rays += roomy.build(tracer_, std::span(&job, 1), atlas_);
    const auto expected = results();

    const std::size_t one = roomy.bytes() / maps_.size();
    for (const std::size_t budget : {plenty, one, 2 * one, std::size_t{0}}) {
        LocalMapPass pass(maps_, budget);
        EXPECT_EQ(pass.build(tracer_, jobs, atlas_), rays);
        EXPECT_EQ(results(), expected) << budget;
        EXPECT_LE(pass.bytes(), std::max(budget, one));
        if (budget == plenty) {
            EXPECT_LE(pass.dispatches(), 2 * localMapFaceSizes.size() - 1);
        }
    }
}

TEST_F(LocalMapPassGlTest, theMapAskedForLongestAgoGivesUpItsPlace) {
    ReferenceMapBuffer roomy(maps_, plenty);
    const std::size_t one = roomy.bytes() / maps_.size();
    ReferenceMapBuffer buffer(maps_, 2 * one + one / 2);
    ASSERT_EQ(buffer.places(), 2u);
    buffer.startBatch();
    EXPECT_TRUE(buffer.hold(maps_[0]));
    EXPECT_TRUE(buffer.hold(maps_[1]));
    EXPECT_FALSE(buffer.hold(maps_[2])) << "all places hold maps of this batch";
    EXPECT_TRUE(buffer.hold(maps_[0]));
    buffer.startBatch();
    EXPECT_TRUE(buffer.hold(maps_[1]));
    buffer.startBatch();
    EXPECT_TRUE(buffer.hold(maps_[2])) << "in the place of map 0";
    EXPECT_EQ(buffer.uploads(), 3u);
    EXPECT_EQ(buffer.heldBytes(), 2 * maps_[0].bytes());
    EXPECT_TRUE(buffer.hold(maps_[1]));
    EXPECT_EQ(buffer.uploads(), 3u) << "map 1 never left";
}

}  // namespace
}  // namespace reflection
