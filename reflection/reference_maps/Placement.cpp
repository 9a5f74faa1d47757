#include "reflection/reference_maps/Placement.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <limits>
#include <queue>
#include <unordered_map>

namespace reflection {

namespace {

/// Evenly spread directions (Fibonacci lattice on the sphere).
std::vector<glm::vec3> sphereDirections(int count) {
    std::vector<glm::vec3> directions;
    const double golden = 2.399963229728653;
    for (int i = 0; i < count; ++i) {
        const double z = 1 - (2.0 * i + 1) / count;
        const double r = std::sqrt(std::max(0.0, 1 - z * z));
        directions.emplace_back(r * std::cos(golden * i), r * std::sin(golden * i), z);
    }
    return directions;
}

std::uint64_t cubeKey(const glm::vec3& p, float size) {
    const auto part = [size](float x) {
        return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(x / size))) & 0x1fffff;
    };
    return part(p.x) | (part(p.y) << 21) | (part(p.z) << 42);
}

/// One position for each `cell` metres square.
std::vector<glm::vec3> thinned(std::span<const glm::vec3> positions, float cell) {
    std::unordered_map<std::uint64_t, char> seen;
    std::vector<glm::vec3> kept;
    for (const glm::vec3& p : positions)
        if (seen.emplace(cubeKey(p, cell), 0).second) kept.push_back(p);
    return kept;
}

/// Points on the surfaces that can be seen from the driving positions, one a cube.
std::vector<glm::vec3> visibleSurface(const GridTracer& tracer, std::span<const glm::vec3> positions,
                                      const PlacementOptions& options) {
    const std::vector<glm::vec3> directions = sphereDirections(options.directions);
    std::vector<float> dx, dy, dz;
    for (const glm::vec3& d : directions) {
        dx.push_back(d.x);
        dy.push_back(d.y);
        dz.push_back(d.z);
    }
    // Half of a car's height: what its doors and bonnet see.
    constexpr float eyeHeight = 0.8f;
    std::vector<std::vector<float>> hits(positions.size(), std::vector<float>(directions.size()));
    tbb::parallel_for(std::size_t{0}, positions.size(), [&](std::size_t i) {
        tracer.traceFan(positions[i] + glm::vec3(0, 0, eyeHeight), dx, dy, dz, hits[i]);
    });
    std::unordered_map<std::uint64_t, char> seen;
    std::vector<glm::vec3> surface;
    for (std::size_t i = 0; i < positions.size(); ++i) {
        const glm::vec3 eye = positions[i] + glm::vec3(0, 0, eyeHeight);
        for (std::size_t k = 0; k < directions.size(); ++k) {
            const float t = hits[i][k];
            if (!(t <= options.range)) continue;
            // Drawn towards the eye by a millimetre so that the cube is the one in front of the surface.
            const glm::vec3 p = eye + directions[k] * (t - 1e-3f);
            if (seen.emplace(cubeKey(p, options.sampleSize), 0).second) surface.push_back(p);
        }
    }
    return surface;
}

/// Samples that a map at `eye` sees: the ray towards the sample ends there.
std::vector<std::uint32_t> seenFrom(const GridTracer& tracer, const glm::vec3& eye,
                                    std::span<const glm::vec3> surface, float range) {
    std::vector<std::uint32_t> seen, asked;
    std::vector<float> dx, dy, dz;
    for (std::uint32_t i = 0; i < surface.size(); ++i) {
        const glm::vec3 d = surface[i] - eye;
        if (glm::dot(d, d) > range * range) continue;
        asked.push_back(i);
        dx.push_back(d.x);
        dy.push_back(d.y);
        dz.push_back(d.z);
    }
    std::vector<float> t(asked.size());
    tracer.traceFan(eye, dx, dy, dz, t);
    for (std::size_t k = 0; k < asked.size(); ++k) {
        // A sample lies a millimetre before its surface; a grazing ray may enter the surface's own cell up to
        // 5 cm early.
        const float length = std::sqrt(dx[k] * dx[k] + dy[k] * dy[k] + dz[k] * dz[k]);
        if (t[k] * length >= length - 0.05f) seen.push_back(asked[k]);
    }
    return seen;
}

}  // namespace

Placement placeReferenceMaps(const GridTracer& tracer, std::span<const glm::vec3> drivingPositions,
                             const PlacementOptions& options) {
    Placement result;
    result.coverage = 1;
    if (drivingPositions.empty()) return result;

    const std::vector<glm::vec3> eyes = thinned(drivingPositions, 4);
    const std::vector<glm::vec3> surface = visibleSurface(tracer, eyes, options);
    const std::vector<glm::vec3> stands = thinned(drivingPositions, 8);
    result.samples = surface.size();
    result.candidates = stands.size();

    std::vector<std::vector<std::uint32_t>> seen(stands.size());
    tbb::parallel_for(std::size_t{0}, stands.size(), [&](std::size_t i) {
        seen[i] = seenFrom(tracer, stands[i] + glm::vec3(0, 0, options.mapHeight), surface, options.range);
    });

    // Lazy greedy: a candidate's gain only shrinks, so the top of the heap is right once its gain is up to
    // date.
    std::vector<char> covered(surface.size(), 0), chosen(stands.size(), 0);
    std::size_t coveredCount = 0;
    const auto gainOf = [&](std::size_t i) {
        return static_cast<std::size_t>(
            std::count_if(seen[i].begin(), seen[i].end(), [&](std::uint32_t s) { return !covered[s]; }));
    };
    const auto choose = [&](std::size_t i) {
        chosen[i] = 1;
        for (std::uint32_t s : seen[i]) {
            coveredCount += covered[s] ? 0 : 1;
            covered[s] = 1;
        }
        result.positions.push_back(stands[i] + glm::vec3(0, 0, options.mapHeight));
    };
    const auto byGainThenIndex = [](const std::pair<std::size_t, std::size_t>& a,
                                    const std::pair<std::size_t, std::size_t>& b) {
        return a.first != b.first ? a.first < b.first : a.second > b.second;
    };
    std::priority_queue<std::pair<std::size_t, std::size_t>, std::vector<std::pair<std::size_t, std::size_t>>,
                        decltype(byGainThenIndex)>
        heap(byGainThenIndex);
    for (std::size_t i = 0; i < stands.size(); ++i) heap.emplace(seen[i].size(), i);
    const auto enough = static_cast<std::size_t>(
        std::ceil(static_cast<double>(options.coverage) * static_cast<double>(surface.size())));
    while (coveredCount < enough && !heap.empty()) {
        const auto [gain, i] = heap.top();
        heap.pop();
        const std::size_t now = gainOf(i);
        if (now == 0) continue;
        if (now < gain) {
            heap.emplace(now, i);
            continue;
        }
        choose(i);
    }

    if (options.spacing > 0) {
        // Farthest-point filling: the candidate farthest from all maps becomes the next one.
        std::vector<float> nearest(stands.size(), std::numeric_limits<float>::infinity());
        const auto account = [&](const glm::vec3& map) {
            for (std::size_t i = 0; i < stands.size(); ++i)
                nearest[i] =
                    std::min(nearest[i], glm::distance(stands[i] + glm::vec3(0, 0, options.mapHeight), map));
        };
        for (const glm::vec3& map : result.positions) account(map);
        for (;;) {
            const auto farthest = std::max_element(nearest.begin(), nearest.end());
            if (*farthest <= options.spacing) break;
            choose(static_cast<std::size_t>(farthest - nearest.begin()));
            account(result.positions.back());
        }
    }
    if (!surface.empty())
        result.coverage = static_cast<float>(coveredCount) / static_cast<float>(surface.size());
    return result;
}

}  // namespace reflection
