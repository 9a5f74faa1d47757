#include "reflection/tracing/GridTracer.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <bit>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <string>

#include "tests/reflection/tracing/ExactOracle.h"
#include "tests/reflection/tracing/SeededRandom.h"

namespace reflection {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

std::string describe(const city::Ray& ray) {
    char text[256];
    std::snprintf(text, sizeof text, "origin (%a, %a, %a) direction (%a, %a, %a)",
                  static_cast<double>(ray.origin.x), static_cast<double>(ray.origin.y),
                  static_cast<double>(ray.origin.z), static_cast<double>(ray.direction.x),
                  static_cast<double>(ray.direction.y), static_cast<double>(ray.direction.z));
    return text;
}

/// A town with streets, blocks, thin walls, single posts, empty, undefined and endless columns.
city::Heightfield town(SeededRandom& random, int width, int height, float cellSize, glm::dvec2 origin) {
    city::Heightfield field(width, height, cellSize, origin);
    for (int j = 0; j < height; ++j)
        for (int i = 0; i < width; ++i) {
            float h = static_cast<float>(random.below(3)) * 0.125f;
            if (i % 7 > 3 && j % 6 > 2) h = 5.0f + static_cast<float>(((i / 7) * 5 + (j / 6) * 3) % 9);
            switch (random.below(60)) {
                case 0:
                    h = infinity;
                    break;
                case 1:
                    h = -infinity;
                    break;
                case 2:
                    h = std::numeric_limits<float>::quiet_NaN();
                    break;
                case 3:
                    h = static_cast<float>(random.between(0, 12));
                    break;
                case 4:
                    h = -3;
                    break;
                default:
                    break;
            }
            field.set(i, j, h);
        }
    return field;
}

/// Families of rays that are hard on grid walks.
enum class Family {
    anywhere,
    fromOutside,
    alongBorders,
    throughCorners,
    grazing,
    vertical,
    denormal,
    onWalls,
    farAway,
    onTops,
    slow,
    count
};

city::Ray ray(SeededRandom& random, Family family, const city::Heightfield& field) {
    const double cs = static_cast<double>(field.cellSize());
    const double w = field.width() * cs, h = field.height() * cs;
    const auto border = [&](int axis) {
        const int n = axis == 0 ? field.width() : field.height();
        return static_cast<float>(field.origin()[axis] + random.below(n + 1) * cs);
    };
    const auto inside = [&] {
        return glm::vec3(field.origin().x + random.between(0, w), field.origin().y + random.between(0, h),
                         random.between(0.1, 14));
    };
    const auto any = [&] {
        return glm::vec3(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1) * random.unit());
    };
    const auto oneOf = [&](std::initializer_list<float> values) {
        return values.begin()[random.below(static_cast<int>(values.size()))];
    };
    city::Ray r{inside(), any()};
    switch (family) {
        case Family::anywhere:
            break;
        case Family::fromOutside:
            r.origin.x += static_cast<float>(random.between(-3, 3) * w);
            r.origin.y += static_cast<float>(random.between(-3, 3) * h);
            r.direction = inside() - r.origin;
            break;
        case Family::alongBorders: {
            const int axis = random.below(2);
            r.origin[axis] = border(axis);
            r.direction[axis] = oneOf({0.0f, -0.0f, 1e-30f, -1e-30f});
            break;
        }
        case Family::throughCorners: {
            // A target corner minus a multiple of the direction that a float holds exactly.
            const glm::vec2 corner(border(0), border(1));
            const float dx = static_cast<float>(random.below(9) - 4),
                        dy = static_cast<float>(random.below(9) - 4);
            const float m = oneOf({0.0f, 0.25f, 0.5f, 1, 2, 3});
            r.direction = {dx * field.cellSize(), dy * field.cellSize(),
                           oneOf({0.0f, 0.5f, -0.5f, -0.125f, -2, 1})};
            r.origin = {corner.x - m * r.direction.x, corner.y - m * r.direction.y,
                        oneOf({0.5f, 1.5f, 5, 6, 7.25f})};
            if (random.below(4) == 0) r.origin.x = std::nextafter(r.origin.x, oneOf({-infinity, infinity}));
            break;
        }
        case Family::grazing:
            if (random.below(2) != 0)
                r.direction.z = oneOf({1e-7f, -1e-7f, 1e-9f, -1e-9f, 0});
            else
                r.direction[random.below(2)] = oneOf({1e-7f, -1e-7f, 1e-9f, -1e-9f});
            if (random.below(2) != 0) r.origin.z = oneOf({0.125f, 0.25f, 5, 6, 9});
            if (random.below(3) == 0) {
                const int axis = random.below(2);
                r.origin[axis] = std::nextafter(border(axis), oneOf({-infinity, infinity}));
            }
            break;
        case Family::vertical:
            r.direction = {oneOf({0, -0.0f, 1e-40f}), oneOf({0, -0.0f, -1e-40f}),
                           oneOf({1, -1, 1e-40f, -1e-40f})};
            if (random.below(2) != 0) r.origin.x = border(0);
            if (random.below(2) != 0) r.origin.y = border(1);
            break;
        case Family::denormal: {
            for (int c = 0; c < 3; ++c)
                if (random.below(2) != 0) r.direction[c] *= oneOf({1e-38f, 1e-42f, 1e-45f});
            if (random.below(3) == 0) r.direction *= 1e-44f;
            if (random.below(2) != 0) r.origin[random.below(3)] = oneOf({1e-45f, -1e-45f, 1e-39f, 0});
            if (r.direction == glm::vec3(0)) r.direction.x = 1e-45f;
            break;
        }
        case Family::onWalls: {
            r.origin.x = border(0);
            if (random.below(2) != 0) r.origin.y = border(1);
            if (random.below(2) != 0) r.origin.z = oneOf({0, 0.125f, 0.25f, 5, 6, 9});
            if (random.below(2) != 0)
                r.direction = {oneOf({-1, 1}), oneOf({-1, 0, 1}), oneOf({-1, 0, 1, 0.25f})};
            break;
        }
        case Family::farAway: {
            const float distance = oneOf({1e4f, 1e6f, 1e9f, 1e20f, 1e37f});
            const glm::vec3 target = random.below(2) != 0 ? inside() : glm::vec3(border(0), border(1), 3);
            const glm::vec3 d = oneOf({1, -1}) * any();
            r.origin = target - distance * d;
            r.direction = random.below(2) != 0 ? d : distance * d;
            break;
        }
        case Family::onTops:
            r.origin.z = oneOf({0, 0.125f, 0.25f, 5, 6, 7, 9});
            r.direction.z = oneOf({0, 0, -0.0f, -1e-6f, 1e-6f, -0.125f});
            break;
        case Family::slow:
            r.direction *= oneOf({1e-12f, 1e-20f, 1e12f, 1e20f, 1e37f});
            break;
        case Family::count:
            break;
    }
    return r;
}

struct Setting {
    int width, height;
    float cellSize;
    glm::dvec2 origin;
};
const Setting settings[] = {
    {24, 20, 1.0f, {0, 0}},      {17, 23, 1.0f, {-8, -11}},         {9, 31, 0.5f, {100.25, -7.125}},
    {20, 20, 0.1f, {0.3, -0.7}}, {13, 12, 2.7f, {1234.567, 765.4}}, {1, 1, 1.0f, {0, 0}},
    {40, 3, 1.0f, {-1e5, 3e5}},
};

/// Runs the check once for each instruction set that this processor has, the best one last.
template <class Check>
void onEveryInstructionSet(Check check) {
    const std::int64_t all = hwy::SupportedTargets();
    for (int bit = 62; bit >= 0; --bit) {
        const std::int64_t target = std::int64_t{1} << bit;
        if ((all & target) == 0) continue;
        hwy::SetSupportedTargetsForTest(target);
        hwy::GetChosenTarget().Update(hwy::SupportedTargets());
        SCOPED_TRACE(hwy::TargetName(target));
        check();
    }
    hwy::SetSupportedTargetsForTest(0);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

/// Status and cell must be equal, t within the derived bound. Returns how many rays hit.
int compareWithOracle(int raysOfFamily) {
    int hits = 0;
    std::uint64_t seed = 0;
    for (const Setting& s : settings) {
        SeededRandom random(++seed);
        const city::Heightfield field = town(random, s.width, s.height, s.cellSize, s.origin);
        const GridTracer tracer(field);
        const ExactOracle oracle(field);
        for (int family = 0; family < static_cast<int>(Family::count); ++family)
            for (int k = 0; k < raysOfFamily; ++k) {
                const city::Ray r = ray(random, static_cast<Family>(family), field);
                const TraceResult got = tracer.trace(r);
                ExactOracle::Answer want = oracle.trace(r);
                if (want.status == TraceStatus::hit && ExactOracle::beyondFloats(want))
                    want.status = TraceStatus::miss;
                EXPECT_EQ(got.status, want.status)
                    << "family " << family << ", field " << seed << ", " << describe(r);
                if (got.status != want.status || want.status != TraceStatus::hit) continue;
                ++hits;
                EXPECT_EQ(got.cell, want.cell)
                    << "family " << family << ", field " << seed << ", " << describe(r);
                EXPECT_TRUE(ExactOracle::withinBound(got.t, want))
                    << got.t << ", family " << family << ", field " << seed << ", " << describe(r);
            }
    }
    return hits;
}

TEST(GridTracerTest, agreesWithExactOracleOnEveryFamilyOfRays) {
    // 7 fields x 11 families x 1,400 rays: 107,800.
    EXPECT_GT(compareWithOracle(1400), 40000);
}

TEST(GridTracerTest, agreesWithExactOracleOnEveryInstructionSet) {
    onEveryInstructionSet([] { EXPECT_GT(compareWithOracle(200), 5000); });
}

void compareFansWithSingleRays() {
    std::uint64_t seed = 100;
    for (const Setting& s : settings) {
        SeededRandom random(++seed);
        const city::Heightfield field = town(random, s.width, s.height, s.cellSize, s.origin);
        const GridTracer tracer(field);
        for (int family = 0; family < static_cast<int>(Family::count); ++family)
            for (int fan = 0; fan < 12; ++fan) {
                const glm::vec3 origin = ray(random, static_cast<Family>(family), field).origin;
                std::vector<float> dx, dy, dz;
                const int count = random.below(70);
                for (int k = 0; k < count; ++k) {
                    const glm::vec3 d = ray(random, static_cast<Family>(family), field).direction;
                    dx.push_back(random.below(50) == 0 ? std::numeric_limits<float>::quiet_NaN() : d.x);
                    dy.push_back(d.y);
                    dz.push_back(d.z);
                }
                std::vector<float> t(dx.size(), -1);
                tracer.traceFan(origin, dx, dy, dz, t);
                for (std::size_t k = 0; k < t.size(); ++k) {
                    const city::Ray r{origin, {dx[k], dy[k], dz[k]}};
                    const TraceResult one = tracer.trace(r);
                    if (one.status == TraceStatus::invalid) {
                        ASSERT_TRUE(std::isnan(t[k])) << describe(r);
                    } else {
                        ASSERT_EQ(std::bit_cast<std::uint32_t>(t[k]), std::bit_cast<std::uint32_t>(one.t))
                            << t[k] << " and " << one.t << ", family " << family << ", " << describe(r);
                    }
                }
            }
    }
}

TEST(GridTracerTest, fanAgreesWithSingleRaysBitForBit) {
    compareFansWithSingleRays();
}

TEST(GridTracerTest, fanAgreesWithSingleRaysOnEveryInstructionSet) {
    onEveryInstructionSet(compareFansWithSingleRays);
}

/// As many rays as several batches of the fan's walk, and a few more, over streets long enough for many
/// leaps: every ray's parameter must come back to its own place.
TEST(GridTracerTest, longFansAgreeWithSingleRaysOnEveryInstructionSet) {
    SeededRandom random(42);
    const city::Heightfield field = town(random, 160, 140, 1, {-20, 30});
    std::vector<float> dx, dy, dz;
    for (int k = 0; k < 3000 + 13; ++k) {
        dx.push_back(static_cast<float>(random.between(-1, 1)));
        dy.push_back(static_cast<float>(random.between(-1, 1)));
        dz.push_back(static_cast<float>(random.between(-1, 1)) * static_cast<float>(random.unit()));
    }
    onEveryInstructionSet([&] {
        const GridTracer tracer(field);
        for (const glm::vec3 origin : {glm::vec3(40.3f, 101.6f, 1.5f), glm::vec3(33.0f, 88.5f, 14.25f)}) {
            std::vector<float> t(dx.size(), -1);
            tracer.traceFan(origin, dx, dy, dz, t);
            for (std::size_t k = 0; k < t.size(); ++k)
                ASSERT_EQ(t[k], tracer.trace({origin, {dx[k], dy[k], dz[k]}}).t) << "ray " << k;
        }
    });
}

TEST(GridTracerTest, diagonalPairOfColumnsLeavesNoGap) {
    city::Heightfield field(4, 4, 1, {0, 0});
    for (float& h : field.cells()) h = 0;
    field.set(2, 1, 10);
    field.set(1, 2, 10);
    const GridTracer tracer(field);
    // Through the corner (2, 2) from both sides, exactly.
    const TraceResult ahead = tracer.trace({{0.5f, 0.5f, 1}, {1, 1, 0}});
    EXPECT_EQ(ahead.status, TraceStatus::hit);
    EXPECT_EQ(ahead.cell, glm::ivec2(2, 1));
    EXPECT_EQ(ahead.t, 1.5f);
    const TraceResult back = tracer.trace({{3.5f, 3.5f, 1}, {-1, -1, 0}});
    EXPECT_EQ(back.status, TraceStatus::hit);
    EXPECT_EQ(back.cell, glm::ivec2(1, 2));
}

TEST(GridTracerTest, startOnWallHitsOnItsSolidSideOnly) {
    city::Heightfield field(4, 1, 1, {0, 0});
    for (float& h : field.cells()) h = 0;
    field.set(2, 0, 10);
    const GridTracer tracer(field);
    EXPECT_EQ(tracer.trace({{2, 0.5f, 1}, {-1, 0, 0}}).t, 0);  // on the west face: inside
    EXPECT_EQ(tracer.trace({{3, 0.5f, 1}, {1, 0, 0}}).status, TraceStatus::miss);
    const TraceResult inwards = tracer.trace({{3, 0.5f, 1}, {-1, 0, 0}});
    EXPECT_EQ(inwards.status, TraceStatus::hit);
    EXPECT_EQ(std::bit_cast<std::uint32_t>(inwards.t), 0u) << "no negative zero";
}

TEST(GridTracerTest, invalidRaysAreTold) {
    const GridTracer tracer(city::Heightfield(2, 2, 1, {0, 0}));
    const float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(tracer.trace({{nan, 0, 0}, {1, 0, 0}}).status, TraceStatus::invalid);
    EXPECT_EQ(tracer.trace({{0, 0, 0}, {infinity, 0, 0}}).status, TraceStatus::invalid);
    EXPECT_EQ(tracer.trace({{0, 0, 0}, {0, -0.0f, 0}}).status, TraceStatus::invalid);
}

TEST(GridTracerTest, hitsBeyondTMaxAreMisses) {
    SeededRandom random(7);
    const city::Heightfield field = town(random, 24, 20, 1, {0, 0});
    const GridTracer tracer(field);
    int cut = 0;
    for (int k = 0; k < 5000; ++k) {
        const city::Ray r =
            ray(random, static_cast<Family>(random.below(static_cast<int>(Family::count))), field);
        const TraceResult full = tracer.trace(r);
        const float tMax = static_cast<float>(random.between(0, 10));
        for (const float limit : {tMax, full.t}) {
            const TraceResult limited = tracer.trace(r, limit);
            const bool reaches = full.status == TraceStatus::hit && full.t <= limit;
            ASSERT_EQ(limited.status == TraceStatus::hit, reaches) << describe(r);
            if (reaches) {
                ASSERT_EQ(limited.t, full.t);
            } else {
                ++cut;
            }
        }
    }
    EXPECT_GT(cut, 1000);
}

/// Found by `mirrorstreet stability`.
TEST(GridTracerTest, subnormalHeightsAreToldApartInFans) {
    // Products of numbers this small are 0 in float: nothing may be concluded from them.
    city::Heightfield field(1, 1, 1, {0, 0});
    field.set(0, 0, 0);
    const GridTracer tracer(field);
    const glm::vec3 origin(0x1.aaa33cp-2f, 0x1.ab9de8p-1f, 0x1p-149f),
        d(-0x1.f0d86p-1f, -0.0f, -0x1.d8p-143f);
    for (const std::size_t count : {1u, 4u}) {
        const std::vector<float> dx(count, d.x), dy(count, d.y), dz(count, d.z);
        std::vector<float> t(count, -1);
        tracer.traceFan(origin, dx, dy, dz, t);
        for (const float each : t) EXPECT_EQ(each, tracer.trace({origin, d}).t);
    }
}

TEST(GridTracerTest, limitsAreKeptAtSubnormalParameters) {
    // From just before a wall, so fast that it is reached within the least of floats; the other direction
    // runs along a border, so that the exact walk decides.
    city::Heightfield field(8, 8, 1, {0, 0});
    for (float& h : field.cells()) h = 0;
    field.set(4, 4, infinity);
    const GridTracer tracer(field);
    for (const float speed : {0x1.7p126f, 0x1.8p126f, 0x1p127f, 0x1.8p127f}) {
        const city::Ray ray{{std::nextafter(4.0f, 0.0f), 4, 1}, {speed, 0, 0}};
        const TraceResult hit = tracer.trace(ray);
        ASSERT_EQ(hit.t, std::numeric_limits<float>::denorm_min());
        EXPECT_EQ(tracer.trace(ray, hit.t).status, TraceStatus::hit) << speed;
        EXPECT_EQ(tracer.trace(ray, 0).status, TraceStatus::miss) << speed;
    }
}

TEST(GridTracerTest, limitsAreKeptNearerThanCoordinatesInCellsCanTell) {
    // A quarter of a millionth of a millionth of a cell before a border, whose double is not the start's
    // float.
    city::Heightfield field(30, 26, 0.05f, {0.3, -0.7});
    for (float& h : field.cells()) h = 0;
    field.set(17, 14, infinity);
    const GridTracer tracer(field);
    const city::Ray ray{{0x1.2ca328p+0f, 0x1.666666p-27f, 0x1.0464d8p-3f},
                        {0, 0x1.239448p-2f, -0x1.81ad2ep-1f}};
    const TraceResult hit = tracer.trace(ray);
    ASSERT_EQ(hit.cell, glm::ivec2(17, 14));
    ASSERT_LT(hit.t, 1e-15f);
    EXPECT_EQ(tracer.trace(ray, hit.t).status, TraceStatus::hit);
    EXPECT_EQ(tracer.trace(ray, std::nextafter(hit.t, 0.0f)).status, TraceStatus::miss);
}

TEST(GridTracerTest, aStartThatRoundsOntoTheBorderAlongWhichItRunsKeepsItsRow) {
    city::Heightfield field(21, 9, 100, {-1000, -900});
    for (float& h : field.cells()) h = 0;
    field.set(1, 8, infinity);
    const GridTracer tracer(field);
    // A hair south of y = 0, the far border of row 8; in double, 900 m from the corner, it is y = 0.
    const TraceResult hit = tracer.trace({{-343, -0x1p-149f, 1}, {-1, 0, 0}});
    EXPECT_EQ(hit.status, TraceStatus::hit);
    EXPECT_EQ(hit.cell, glm::ivec2(1, 8));
}

TEST(GridTracerTest, occlusionIsSeenBetweenPointsOnly) {
    city::Heightfield field(10, 1, 1, {0, 0});
    for (float& h : field.cells()) h = 0;
    field.set(5, 0, 10);
    const GridTracer tracer(field);
    EXPECT_TRUE(tracer.occluded({1, 0.5f, 1}, {9, 0.5f, 1}));
    EXPECT_FALSE(tracer.occluded({1, 0.5f, 1}, {4, 0.5f, 1}));
    EXPECT_FALSE(tracer.occluded({1, 0.5f, 1}, {5, 0.5f, 1})) << "the point lies on the facade";
    EXPECT_TRUE(tracer.occluded({1, 0.5f, 1}, {5.25f, 0.5f, 1}));
    EXPECT_FALSE(tracer.occluded({1, 0.5f, 1}, {5.25f, 0.5f, 1}, 0.5f)) << "within the slack";
    EXPECT_FALSE(tracer.occluded({1, 0.5f, 1}, {1, 0.5f, 1}));
}

TEST(GridTracerTest, refusesFieldsWhoseBordersCoincide) {
    EXPECT_THROW(GridTracer(city::Heightfield(4, 4, 1, {1e17, 0})), std::invalid_argument);
    EXPECT_THROW(GridTracer(city::Heightfield(4, 4, 1e20f, {1e31, 0})), std::invalid_argument);
}

}  // namespace
}  // namespace reflection
