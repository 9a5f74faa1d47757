// Reference maps: cube edges and corners, coincident centres, points on centres and axes, distances of 1e-3
// to 1e5 m.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <filesystem>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <vector>

#include "app/stability/SeededRandom.h"
#include "app/stability/Stability.h"
#include "reflection/local_map/LocalMapBuilder.h"
#include "reflection/reference_maps/CubeMapping.h"
#include "reflection/reference_maps/PackedReferenceMap.h"
#include "reflection/reference_maps/Selection.h"
#include "reflection/tracing/GridTracer.h"

namespace app::stability {

namespace {

using reflection::Candidate;
using reflection::LocalMap;
using reflection::PackedReferenceMap;

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float radianceScale = 8;

/// What packing may do to a brightness: PackedReferenceMap.h, a step of 5 mantissa bits by the dither.
constexpr double packedBrightness = 1.0 / 32;
/// And to a nearness: half a step of 7 mantissa bits.
constexpr double packedNearness = 1.0 / 256;

/// Grey that changes smoothly with the direction: by at most `greySlope` a radian.
constexpr double greySlope = 0.2;
double greyOf(const glm::dvec3& d) {
    return 0.5 + greySlope * glm::dot(glm::normalize(d), glm::dvec3(0.48, 0.6, 0.64));
}

/// A sphere of this radius around the map, grey by direction.
PackedReferenceMap sphereMap(const glm::dvec3& centre, double radius, int faceSize) {
    reflection::ReferenceMap map;
    map.position = centre;
    map.faceSize = faceSize;
    for (int face = 0; face < 6; ++face)
        for (int y = 0; y < faceSize; ++y)
            for (int x = 0; x < faceSize; ++x) {
                const glm::vec3 d = reflection::cubeDirection(face, glm::vec2(x, y) + 0.5f, faceSize);
                map.colour.emplace_back(static_cast<float>(greyOf(d)));
                map.distance.push_back(static_cast<float>(radius));
            }
    return {map, radianceScale};
}

LocalMap emptyMap(int n) {
    LocalMap map;
    map.resize(n);
    return map;
}

/// Directions on edges and corners of the cube, and a float beside them.
glm::vec3 edgeDirection(SeededRandom& random) {
    const int axis = random.below(3);
    glm::vec3 d;
    for (int c = 0; c < 3; ++c) d[c] = random.oneIn(2) ? 1.0f : -1.0f;
    if (!random.oneIn(4)) d[axis] = static_cast<float>(random.between(-1, 1));
    if (random.oneIn(2)) {
        const int c = random.below(3);
        d[c] = std::nextafter(d[c], random.oneIn(2) ? 0.0f : 2 * d[c]);
    }
    return d;
}

Row cubePoints(const Options& options) {
    Row row{"maps",
            "directions on cube edges and corners come back from face coordinates",
            0,
            0,
            0,
            0x1p-22,
            "rad",
            "one rounded quotient of 2^-24 in each of s and t, of at most 1: sqrt 2 * 2^-24, and two "
            "sums",
            ""};
    SeededRandom random(options.seed, 1);
    for (int k = 0; k < 200'000 * options.effort(); ++k) {
        const glm::vec3 unit = edgeDirection(random);
        const glm::vec3 d = unit * static_cast<float>(random.magnitude(1e-30, 1e30));
        const reflection::CubePoint p = reflection::cubePoint(d);
        const auto& f = reflection::cubeFaces[static_cast<std::size_t>(p.face)];
        const glm::dvec3 back = glm::dvec3(f.major) + static_cast<double>(p.st.x) * glm::dvec3(f.sAxis) +
                                static_cast<double>(p.st.y) * glm::dvec3(f.tAxis);
        const glm::dvec3 truth = glm::normalize(glm::dvec3(d));
        const double angle = glm::length(glm::cross(glm::normalize(back), truth));
        ++row.tried;
        row.worst = std::max(row.worst, angle);
        if (!(angle <= row.bound) || !(std::max(std::abs(p.st.x), std::abs(p.st.y)) <= 1) ||
            glm::dot(back, truth) < 0)
            ++row.failures;
    }
    return row;
}

/// Colours in directions on edges and corners, by the lookup that local maps use.
Row seams(const Options& options) {
    constexpr int faceSize = 64, local = 32;
    // levelFor gives two texels for one of the local map's: here the finest. A texel is widest in a face's
    // middle: 2 / 64 rad.
    const double texel = 2.0 / faceSize;
    Row row{"maps",
            "brightness across cube edges and corners, every direction",
            0,
            0,
            0,
            0,
            "of white",
            "a texel's width (2/64 rad) times the slope, and a step of 5 mantissa bits of the brightest",
            ""};
    row.bound = texel * greySlope + 3 * (0.5 + greySlope) * packedBrightness / 3;
    const PackedReferenceMap map = sphereMap({0, 0, 0}, 10, faceSize);
    const Candidate here{&map, glm::vec3(0)};
    SeededRandom random(options.seed, 2);
    constexpr std::size_t count = local * local;
    std::vector<float> x(count), y(count), z(count), w(count, 1.0f);
    LocalMap out = emptyMap(local);
    for (int round = 0; round < 100 * options.effort(); ++round) {
        for (std::size_t k = 0; k < count; ++k) {
            const glm::vec3 p = edgeDirection(random) * static_cast<float>(random.magnitude(1e-3, 1e5));
            x[k] = p.x;
            y[k] = p.y;
            z[k] = p.z;
        }
        reflection::lookUpBlended(0, x, y, z, w, here, here, out);
        for (std::size_t k = 0; k < count; ++k) {
            const double error = std::abs(static_cast<double>(out.green[k]) - greyOf({x[k], y[k], z[k]}));
            ++row.tried;
            row.worst = std::max(row.worst, error);
            row.failures += !(error <= row.bound) ? 1 : 0;
        }
    }
    return row;
}

Row packedDistances(const Options& options) {
    Row row{"maps",
            "distances of 1/8 to 8192 m as packed",
            0,
            0,
            0,
            packedNearness,
            "of the distance",
            "half a step of 7 mantissa bits, PackedReferenceMap.h",
            ""};
    SeededRandom random(options.seed, 3);
    for (int k = 0; k < 40 * options.effort(); ++k) {
        constexpr int n = 16;
        const double radius = random.magnitude(0.25, 4000);
        const PackedReferenceMap map = sphereMap({0, 0, 0}, radius, n);
        for (int face = 0; face < 6; ++face)
            for (int y = 0; y < n; ++y)
                for (int x = 0; x < n; ++x) {
                    const auto d = static_cast<double>(map.levels().front().distanceAt(face, x, y));
                    const double error = std::abs(d / radius - 1);
                    ++row.tried;
                    row.worst = std::max(row.worst, error);
                    // The stored reciprocal is off by half a step; so is the distance, to second order.
                    row.failures += !(error <= row.bound) ? 1 : 0;
                }
    }
    row.bound *= 1 + packedNearness;
    return row;
}

bool isColour(float v) {
    // Within what the map holds, 0.5 -+ slope, widened by packing and chroma of 8 bits.
    const double low = (0.5 - greySlope) * (1 - packedBrightness - 3.0 / 255) - 1e-3;
    const double high = (0.5 + greySlope) * (1 + packedBrightness + 3.0 / 255) + 1e-3;
    return v >= low && v <= high;
}

/// Distances of 1e-3 to 1e5 m, also outside what a packed map can tell: nothing but colours of the map may
/// come out, and depths within the packed range are right.
std::vector<Row> refined(const Options& options) {
    Row colours{"maps",
                "refined lookups at 1e-3 to 1e5 m: colours of the map, positive depths",
                0,
                0,
                0,
                0,
                "of them wrong",
                "bilinear weights are convex: no colour beyond the map's",
                ""};
    Row depths{"maps",
               "refined depths at 0.5 to 4000 m from starts off by a factor of 2",
               0,
               0,
               0,
               0,
               "of the distance",
               "",
               ""};
    reflection::LookupOptions lookup;
    depths.bound = static_cast<double>(lookup.agreement) + packedNearness + 5e-3;
    depths.boundFrom =
        "agreement asked for (0.01), packing (2^-8), and a sphere's chord over a texel pair of 1/32 rad, 0.5 "
        "%";
    SeededRandom random(options.seed, 4);
    constexpr int n = 32;
    std::vector<float> starts(n * n);
    LocalMap out = emptyMap(n);
    for (int round = 0; round < 60 * options.effort(); ++round) {
        const double radius = random.magnitude(1e-3, 1e5);
        // The same centre, or one within a hundredth of the radius.
        const glm::dvec3 offset =
            round % 3 == 0
                ? glm::dvec3(0)
                : 0.01 * radius *
                      glm::dvec3(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1));
        const PackedReferenceMap map = sphereMap(offset, radius, 64);
        const std::array<Candidate, 2> twice{{{&map, glm::vec3(offset)}, {&map, glm::vec3(offset)}}};
        for (int face = 0; face < 6; ++face) {
            for (float& s : starts)
                s = random.oneIn(8) ? (random.oneIn(2) ? 0.0f : 1e3f)
                                    : static_cast<float>(random.magnitude(0.5, 2) / radius);
            const auto given = starts;
            reflection::lookUpRefined(face, starts, twice, lookup, out);
            for (std::size_t k = 0; k < starts.size(); ++k) {
                const std::size_t at = out.faceOffset(face) + k;
                ++colours.tried;
                if (!isColour(out.red[at]) || !isColour(out.green[at]) || !isColour(out.blue[at]) ||
                    !(out.depth[at] > 0)) {
                    ++colours.failures;
                    if (colours.example.empty())
                        colours.example = "radius " + std::to_string(radius) + ", start 1/" +
                                          std::to_string(1 / given[k]) + ", green " +
                                          std::to_string(out.green[at]) + ", depth " +
                                          std::to_string(out.depth[at]);
                }
                if (radius < 0.5 || radius > 4000 || given[k] == 0 || given[k] == 1e3f) continue;
                // The sphere around the map's centre, met by the ray from the local map's.
                const glm::dvec3 d(reflection::cubeDirection(
                    face, glm::vec2(static_cast<float>(k % n), static_cast<float>(k / n)) + 0.5f, n));
                const double a = glm::dot(d, d), b = glm::dot(d, offset),
                             c = glm::dot(offset, offset) - radius * radius;
                const double truth = (b + std::sqrt(b * b - a * c)) / a;
                const double error = std::abs(static_cast<double>(out.depth[at]) / truth - 1);
                ++depths.tried;
                depths.worst = std::max(depths.worst, error);
                depths.failures += !(error <= depths.bound) ? 1 : 0;
            }
        }
    }
    return {colours, depths};
}

/// Points on a map's centre, on the axis between two maps, and infinitely near both.
Row onCentres(const Options& options) {
    Row row{"maps",
            "points on a map's centre, on the axis of two, coincident maps",
            0,
            0,
            0,
            0,
            "of them wrong",
            "a colour of the map, whatever the direction",
            ""};
    SeededRandom random(options.seed, 5);
    constexpr int n = 16;
    constexpr std::size_t count = n * n;
    std::vector<float> x(count), y(count), z(count), w(count);
    LocalMap out = emptyMap(n);
    const PackedReferenceMap first = sphereMap({0, 0, 0}, 10, 32), second = sphereMap({0, 0, 0}, 30, 32);
    for (int round = 0; round < 200 * options.effort(); ++round) {
        const glm::vec3 a(random.between(-5, 5), random.between(-5, 5), random.between(-5, 5));
        const glm::vec3 b =
            round % 3 == 0 ? a : a + glm::vec3(0, 0, static_cast<float>(random.magnitude(1e-30, 10)));
        for (std::size_t k = 0; k < count; ++k) {
            const glm::vec3 p = k % 3 == 0 ? a : glm::mix(a, b, static_cast<float>(random.between(-1, 2)));
            x[k] = p.x;
            y[k] = p.y;
            z[k] = p.z;
            w[k] = static_cast<float>(random.unit());
        }
        reflection::lookUpBlended(round % 6, x, y, z, w, {&first, a}, {&second, b}, out);
        for (std::size_t k = 0; k < count; ++k) {
            ++row.tried;
            const std::size_t at = out.faceOffset(round % 6) + k;
            if (!isColour(out.red[at]) || !isColour(out.green[at]) || !isColour(out.blue[at])) ++row.failures;
            const float stored = reflection::storedDistance({&first, a}, {x[k], y[k], z[k]});
            if (!(stored > 0)) ++row.failures;
        }
    }
    return row;
}

/// Whole local maps by every method between coincident and near-coincident reference maps.
Row wholeMaps(const Options& options) {
    Row row{"maps",
            "local maps by every method between coincident maps",
            0,
            0,
            0,
            0,
            "of them wrong",
            "colours of the map, or of the sky",
            ""};
    SeededRandom random(options.seed, 6);
    city::Heightfield field(40, 40, 1, {-20, -20});
    for (int j = 0; j < 40; ++j)
        for (int i = 0; i < 40; ++i) field.set(i, j, std::hypot(i - 20.0, j - 20.0) > 10 ? 25.0f : 0.0f);
    const reflection::GridTracer tracer(field);
    reflection::LocalMapBuilder builder;
    for (int round = 0; round < 6 * options.effort(); ++round) {
        const glm::dvec3 centre(random.between(-3, 3), random.between(-3, 3), 1.2);
        std::vector<PackedReferenceMap> maps;
        for (int k = 0; k < 5; ++k) maps.push_back(sphereMap(k < 3 ? centre : glm::dvec3(0, 0, 2), 10, 32));
        const auto candidates = reflection::selectCandidates(maps, centre, tracer, 3);
        if (candidates.size() != 3) ++row.failures;
        for (const auto method : {reflection::LocalMapMethod::blend, reflection::LocalMapMethod::box,
                                  reflection::LocalMapMethod::memPaper, reflection::LocalMapMethod::mem})
            for (const int n : {1, 2, 16, 33}) {
                reflection::LocalMapRequest request;
                request.method = method;
                request.centre = centre;
                request.faceSize = n;
                request.candidates = candidates;
                LocalMap map = emptyMap(n);
                for (int face = 0; face < 6; ++face) builder.buildFace(tracer, request, face, map);
                for (std::size_t k = 0; k < map.red.size(); ++k) {
                    ++row.tried;
                    if (!isColour(map.red[k]) || !isColour(map.green[k]) || !isColour(map.blue[k]) ||
                        !(map.depth[k] > 0))
                        ++row.failures;
                }
            }
    }
    return row;
}

}  // namespace

std::vector<Row> tryReferenceMaps(const Options& options) {
    std::vector<Row> rows;
    const auto done = [&](double share) {
        options.tell(share);
        return options.stop();
    };
    rows.push_back(cubePoints(options));
    if (done(0.1)) return rows;
    rows.push_back(seams(options));
    if (done(0.2)) return rows;
    rows.push_back(packedDistances(options));
    for (Row& row : refined(options)) rows.push_back(std::move(row));
    if (done(0.7)) return rows;
    rows.push_back(onCentres(options));
    rows.push_back(wholeMaps(options));
    done(1);
    for (Row& row : rows)
        if (row.bound == 0) row.worst = static_cast<double>(row.failures);
    return rows;
}

}  // namespace app::stability
