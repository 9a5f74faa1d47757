#include "reflection/chrome/ConcaveImages.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

#include "reflection/chrome/ConcaveSearch.h"
#include "reflection/chrome/ThoroughSearch.h"

namespace reflection {

namespace {

/// As in ThoroughSearch: two descents that end nearer than this have found the same point, in radii.
constexpr double samePoint = 2e-5;
/// An image is taken to go on in a neighbour's that lies nearer than this share of its distance to its own
/// place's next image, and than this many radii; else it is followed there.
constexpr double clearShare = 0.3, clearDistance = 0.1;

/// So many places are searched together: as many as fill searchConcave's lanes, and leave all cores some.
constexpr std::size_t searchesATime = 64;

std::uint32_t nearestOf(const PlaceImage& image, std::span<const PlaceImage> among) {
    std::uint32_t best = PlaceImage::none;
    double least = INFINITY;
    for (std::uint32_t k = 0; k < among.size(); ++k) {
        const double d = glm::distance(image.point, among[k].point);
        if (d < least) least = d, best = k;
    }
    return best;
}

}  // namespace

std::vector<std::uint32_t> matches(std::span<const PlaceImage> a, std::span<const PlaceImage> b) {
    std::vector<std::uint32_t> result(a.size(), PlaceImage::none);
    for (std::uint32_t k = 0; k < a.size(); ++k) {
        const std::uint32_t there = nearestOf(a[k], b);
        if (there != PlaceImage::none && nearestOf(b[there], a) == k) result[k] = there;
    }
    return result;
}

ConcaveImages::ConcaveImages(const ReflectorMap& map, const glm::dvec3& eye, const SearchOptions& options)
    : map_(map), eye_(eye), mapEye_(map.frame().toMap(eye)), options_(options) {}

bool ConcaveImages::image(const glm::dvec3& place, const glm::dvec3& point, const glm::dvec3& normal,
                          PlaceImage& made) const {
    const glm::dvec3 mapPlace = map_.frame().toMap(place);
    // From outside, light must come in where the piece is open.
    glm::dvec3 met;
    if (map_.sample(mapPlace).gauge > 1 && entersSurface(map_, mapPlace, point, met) && map_.covered(met) &&
        glm::distance(met, point) > 1e-3)
        return false;
    made.point = point;
    made.onPart = map_.covered(point);
    ReflectionPoint r;
    r.point = map_.frame().fromMap(point);
    r.normal = map_.frame().fromMapDirection(normal);
    made.fromEye = glm::vec3(virtualVertex(r, place) - eye_);
    return std::isfinite(made.fromEye.x + made.fromEye.y + made.fromEye.z);
}

std::vector<PlaceImage> ConcaveImages::everywhere(const glm::dvec3& place) const {
    std::vector<PlaceImage> images;
    if (!std::isfinite(place.x + place.y + place.z)) return images;
    for (const ReflectionPoint& r :
         everyReflectionPoint(map_, mapEye_, map_.frame().toMap(place), options_)) {
        PlaceImage made;
        if (image(place, r.point, r.normal, made)) images.push_back(made);
    }
    return images;
}

void ConcaveImages::everywhere(std::span<const glm::dvec3> places, std::span<const std::uint32_t> at,
                               std::span<std::vector<PlaceImage>> images) const {
    std::vector<glm::dvec3> moved;
    for (const std::uint32_t k : at) {
        const bool finite = std::isfinite(places[k].x + places[k].y + places[k].z);
        moved.push_back(finite ? map_.frame().toMap(places[k]) : mapEye_);
    }
    const ConcavePoints all = searchConcave(map_, mapEye_, moved, true, options_);
    for (std::size_t k = 0; k < at.size(); ++k) {
        if (!std::isfinite(places[at[k]].x + places[at[k]].y + places[at[k]].z)) continue;
        for (const ReflectionPoint& r : all.of(k)) {
            PlaceImage made;
            if (image(places[at[k]], r.point, r.normal, made)) images[k].push_back(made);
        }
    }
}

std::size_t ConcaveImages::follow(const glm::dvec3& place, std::span<const PlaceImage> from,
                                  std::vector<PlaceImage>& into) const {
    if (from.empty() || !std::isfinite(place.x + place.y + place.z)) return 0;
    std::vector<glm::dvec3> starts;
    for (const PlaceImage& i : from) starts.push_back(i.point / map_.frame().stretch);
    std::vector<Candidate> ends(starts.size());
    descendFromStarts(map_, mapEye_, map_.frame().toMap(place), starts, ends, options_);
    std::size_t added = 0;
    for (const Candidate& c : ends) {
        if (!(c.error <= options_.tolerance * options_.tolerance)) continue;
        const bool known = std::any_of(into.begin(), into.end(), [&](const PlaceImage& i) {
            return glm::distance(i.point, c.point) < samePoint;
        });
        PlaceImage made;
        if (known || !image(place, c.point, c.normal, made)) continue;
        into.push_back(made);
        ++added;
    }
    return added;
}

std::vector<std::vector<PlaceImage>> ConcaveImages::ofMesh(std::span<const glm::dvec3> places,
                                                           std::span<const std::uint32_t> triangles,
                                                           double share) const {
    const std::size_t n = places.size();
    std::vector<std::vector<std::uint32_t>> neighbours(n);
    for (std::size_t k = 0; k + 2 < triangles.size(); k += 3)
        for (std::size_t i = 0; i < 3; ++i) {
            neighbours[triangles[k + i]].push_back(triangles[k + (i + 1) % 3]);
            neighbours[triangles[k + (i + 1) % 3]].push_back(triangles[k + i]);
        }
    std::vector<std::vector<PlaceImage>> images(n);
    std::vector<char> reached(n, 0);
    struct Step {
        std::uint32_t place, image;
    };
    std::vector<Step> open;
    const auto reach = [&](std::uint32_t k) {
        reached[k] = 1;
        for (std::uint32_t i = 0; i < images[k].size(); ++i) open.push_back({k, i});
    };
    const auto stride = static_cast<std::size_t>(std::max(1.0, std::floor(1 / std::clamp(share, 1e-6, 1.0))));
    std::vector<std::uint32_t> seeds;
    for (std::size_t k = 0; k < n; k += stride) seeds.push_back(static_cast<std::uint32_t>(k));
    searched_ += seeds.size();
    std::vector<std::vector<PlaceImage>> all(seeds.size());
    tbb::parallel_for(
        std::size_t{0}, (seeds.size() + searchesATime - 1) / searchesATime, [&](std::size_t part) {
            const std::size_t from = part * searchesATime;
            const std::size_t count = std::min(searchesATime, seeds.size() - from);
            everywhere(places, std::span(seeds).subspan(from, count), std::span(all).subspan(from, count));
        });
    for (std::size_t s = 0; s < seeds.size(); ++s) images[seeds[s]] = std::move(all[s]);
    for (const std::uint32_t s : seeds) reach(s);
    std::vector<std::uint32_t> spread(seeds);
    for (std::size_t next = 0;;) {
        // Images first, as far as they go.
        for (std::size_t at = 0; at < open.size(); ++at) {
            const Step step = open[at];
            const PlaceImage own = images[step.place][step.image];
            double alone = clearDistance / clearShare;
            for (std::uint32_t i = 0; i < images[step.place].size(); ++i)
                if (i != step.image)
                    alone = std::min(alone, glm::distance(own.point, images[step.place][i].point));
            for (const std::uint32_t other : neighbours[step.place]) {
                std::vector<PlaceImage>& there = images[other];
                const std::uint32_t nearest = nearestOf(own, there);
                if (nearest != PlaceImage::none &&
                    glm::distance(there[nearest].point, own.point) < clearShare * alone)
                    continue;
                ++searched_;
                const auto before = static_cast<std::uint32_t>(there.size());
                if (follow(places[other], std::span(&own, 1), there) > 0) open.push_back({other, before});
            }
        }
        open.clear();
        // What hangs together with a seed has been asked by its images; places of other bodies have not.
        for (std::size_t at = 0; at < spread.size(); ++at)
            for (const std::uint32_t other : neighbours[spread[at]])
                if (reached[other] == 0) {
                    reached[other] = 1;
                    spread.push_back(other);
                }
        spread.clear();
        while (next < n && reached[next] != 0) ++next;
        if (next == n) break;
        const auto seed = static_cast<std::uint32_t>(next);
        ++searched_;
        images[seed] = everywhere(places[seed]);
        reach(seed);
        spread.push_back(seed);
    }
    return images;
}

}  // namespace reflection
