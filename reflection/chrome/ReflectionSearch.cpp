// Compiled once for every instruction set that Highway knows on this architecture; the best is chosen at run
// time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "reflection/chrome/ReflectionSearch.cpp"
#include <hwy/foreach_target.h>

#include "reflection/chrome/ReflectionSearch.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "reflection/chrome/ConcaveSearch.h"
#include "reflection/chrome/QuickSearch-inl.h"
#include "reflection/chrome/SearchLanes-inl.h"
#include "reflection/chrome/SearchStart-inl.h"
#include "reflection/chrome/ThoroughSearch.h"

HWY_BEFORE_NAMESPACE();
namespace reflection {
namespace HWY_NAMESPACE {

/// Where the part has a rim, descents go on to this residual, radians: which side of it a point ends on then
/// does not hang on where they began.
constexpr double rimTolerance = 1e-12;

/// Convex pieces, second round. What has no answer here comes back outOfSteps. Everything in the map's frame
/// and units. data/shaders/chrome_search.comp and chrome_map.glsl do the same: whoever changes a step here or
/// in the -inl.h files changes them too (ChromeSearchGlTest compares).
void searchPackets(const ReflectorMap& map, const glm::dvec3& eye, std::span<const glm::dvec3> vertices,
                   std::span<ReflectionPoint> points, const SearchOptions& options) {
    const Doubles tag;
    const std::size_t lanes = hn::Lanes(tag);
    const EyeSide eyeSide(map, eye);
    const Num3 eyes = num3(eye);
    const Stretch stretch(map);
    SearchOptions patient = options;
    if (!map.closed()) patient.tolerance = std::min(options.tolerance, rimTolerance);
    for (std::size_t first = 0; first < vertices.size(); first += lanes) {
        const std::size_t n = std::min(lanes, vertices.size() - first);
        Values3 vertex;
        for (std::size_t k = 0; k < lanes; ++k) vertex.set(k, vertices[first + std::min(k, n - 1)]);
        const Num3 v = vertex.load();
        const MD all = num(0) < num(1);
        const Entry entry = enter(map, stretch.takeOut(eyes), stretch.takeOut(v), all);
        const MD visible = hn::Not(entry.enters);
        const Num3 start = startFor(map, eyeSide, v);
        Judged judged = judge(map, eyes, v, start, true);
        const MD poor = hn::And(visible, judged.error > num(poorStart));
        if (!hn::AllFalse(tag, poor)) {
            const Judged deepest = judge(map, eyes, v, stretch.takeOut(eyes + entry.at * (v - eyes)), true);
            judged = choose(deepest.error < judged.error, deepest, judged);
        }
        const Descent descent = descend(map, eyes, v, judged, visible, patient, true);

        Num3 point = descent.best.point, normal = descent.best.normal;
        if (!hn::AllFalse(tag, entry.enters)) {
            const Num3 met = eyes + entry.at * (v - eyes);
            const OnCube at = onCube(stretch.takeOut(met));
            const Num3 m = stretch.normals(at.axes.out(surfaceAt(map, at).m));
            point = choose(entry.enters, met, point);
            normal = choose(entry.enters, (num(1) / root(dot(m, m))) * m, normal);
        }
        Values3 at, up, again;
        Values path, error, lookups, hidden, retried;
        MD failed = hn::And(visible, descent.best.error > num(options.tolerance * options.tolerance));
        if (!map.coveredNormalTable().empty() && !hn::AllFalse(tag, failed)) {
            // What does not arrive has mostly run into the closing surface's creases. From the part itself a
            // descent reaches the reflection point that is there, or leaves the part as well.
            const Descent other = descend(
                map, eyes, v, judge(map, eyes, v, startFromTable(map.coveredNormalTable(), eyeSide, v), true),
                failed, patient, true);
            const MD better = hn::And(failed, other.best.error < descent.best.error);
            const MD arrived =
                hn::And(better, other.best.error <= num(options.tolerance * options.tolerance));
            point = choose(arrived, other.best.point, point);
            normal = choose(arrived, other.best.normal, normal);
            error.store(choose(arrived, other.best.error, descent.best.error));
            again.store(other.best.point);
            retried.store(choose(failed, num(1), num(0)));
            lookups.store(choose(failed, descent.lookups + other.lookups, descent.lookups));
        } else {
            error.store(descent.best.error);
            lookups.store(descent.lookups);
        }
        const Num3 toEye = eyes - point, toVertex = v - point;
        at.store(point);
        up.store(normal);
        path.store(root(dot(toEye, toEye)) + root(dot(toVertex, toVertex)));
        hidden.store(choose(entry.enters, num(1), num(0)));
        for (std::size_t k = 0; k < n; ++k) {
            ReflectionPoint& r = points[first + k];
            r.point = at.get(k);
            r.normal = up.get(k);
            r.path = path.at[k];
            r.lookups = static_cast<std::uint8_t>(r.lookups + lookups.at[k]);
            if (hidden.at[k] > 0) {
                r.residual = 0;
                r.status = ReflectionStatus::hidden;
                continue;
            }
            r.residual = error.at[k] <= 1 ? std::asin(std::sqrt(error.at[k])) : 3.14159265358979;
            if (r.residual <= options.tolerance)
                r.status = map.covered(r.point) ? ReflectionStatus::found : ReflectionStatus::unreflected;
            else if (retried.at[k] > 0 && !map.covered(r.point) && !map.covered(again.get(k)))
                r.status = ReflectionStatus::unreflected;
            else
                r.status = ReflectionStatus::outOfSteps;
        }
    }
}

void descendFrom(const ReflectorMap& map, const glm::dvec3& eye, const glm::dvec3& vertex,
                 std::span<const glm::dvec3> starts, std::span<Candidate> found,
                 const SearchOptions& options) {
    const Doubles tag;
    const std::size_t lanes = hn::Lanes(tag);
    for (std::size_t first = 0; first < starts.size(); first += lanes) {
        const std::size_t n = std::min(lanes, starts.size() - first);
        Values3 start, point, normal;
        Values error;
        for (std::size_t k = 0; k < lanes; ++k) start.set(k, starts[first + std::min(k, n - 1)]);
        const Descent descent =
            descend(map, num3(eye), num3(vertex), judge(map, num3(eye), num3(vertex), start.load(), false),
                    num(0) < num(1), options, false);
        point.store(descent.best.point);
        normal.store(descent.best.normal);
        error.store(descent.best.error);
        for (std::size_t k = 0; k < n; ++k) found[first + k] = {point.get(k), normal.get(k), error.at[k]};
    }
}

bool entryOf(const ReflectorMap& map, const glm::dvec3& from, const glm::dvec3& to, glm::dvec3& point) {
    const Stretch stretch(map);
    const Entry entry = enter(map, stretch.takeOut(num3(from)), stretch.takeOut(num3(to)), num(0) < num(1));
    Values at, enters;
    at.store(entry.at);
    enters.store(choose(entry.enters, num(1), num(0)));
    point = from + at.at[0] * (to - from);
    return enters.at[0] > 0;
}

}  // namespace HWY_NAMESPACE
}  // namespace reflection
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace reflection {

HWY_EXPORT(searchQuickly);
HWY_EXPORT(searchPackets);
HWY_EXPORT(descendFrom);
HWY_EXPORT(entryOf);

void descendFromStarts(const ReflectorMap& map, const glm::dvec3& eye, const glm::dvec3& vertex,
                       std::span<const glm::dvec3> starts, std::span<Candidate> found,
                       const SearchOptions& options) {
    HWY_DYNAMIC_DISPATCH(descendFrom)(map, eye, vertex, starts, found, options);
}

bool entersSurface(const ReflectorMap& map, const glm::dvec3& from, const glm::dvec3& to, glm::dvec3& point) {
    return HWY_DYNAMIC_DISPATCH(entryOf)(map, from, to, point);
}

namespace {

bool finite(const glm::dvec3& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

/// Radians that a point may be off where it is not searched for thoroughly: a pixel in any picture.
constexpr double nearEnough = 1e-3;

/// So many vertices are brought to the map's frame at a time.
constexpr std::size_t block = 256;

}  // namespace

void findReflectionPoints(const ReflectorMap& map, const glm::dvec3& eye,
                          std::span<const glm::dvec3> vertices, std::span<ReflectionPoint> points,
                          const SearchOptions& options, std::span<const glm::dvec3> guesses) {
    if (map.empty() || !finite(eye)) {
        std::fill_n(points.begin(), vertices.size(), ReflectionPoint{});
        return;
    }
    const glm::dvec3 mapEye = map.frame().toMap(eye);
    const bool convex = map.bend() == Bend::convex;
    // From inside nothing is reflected: the eye sees the surface's back.
    const bool inside = convex && !(map.sample(mapEye).gauge > 1);
    std::array<glm::dvec3, block> moved, guessed;
    std::array<std::uint32_t, block> rest;
    std::array<ReflectionPoint, block> answers;
    for (std::size_t first = 0; first < vertices.size(); first += block) {
        const std::size_t n = std::min(block, vertices.size() - first);
        const std::span<const glm::dvec3> in = vertices.subspan(first, n);
        const std::span<ReflectionPoint> out = points.subspan(first, n);
        std::size_t left = n;
        if (convex && !inside) {
            std::span<const glm::dvec3> from;
            if (!guesses.empty()) {
                for (std::size_t k = 0; k < n; ++k) guessed[k] = map.frame().toMap(guesses[first + k]);
                from = std::span(guessed).first(n);
            }
            left = HWY_DYNAMIC_DISPATCH(searchQuickly)(map, mapEye, from, in, out, rest, options);
        } else {
            for (std::size_t k = 0; k < n; ++k) rest[k] = static_cast<std::uint32_t>(k);
        }
        for (std::size_t k = 0; k < left; ++k) {
            const glm::dvec3& v = in[rest[k]];
            moved[k] = finite(v) ? map.frame().toMap(v) : mapEye;
            answers[k].lookups = convex && !inside ? out[rest[k]].lookups : std::uint8_t{0};
        }
        if (convex && !inside) HWY_DYNAMIC_DISPATCH(searchPackets)
        (map, mapEye, std::span(moved).first(left), std::span(answers).first(left), options);
        ConcavePoints all;
        if (!convex) all = searchConcave(map, mapEye, std::span(moved).first(left), false, options);
        for (std::size_t k = 0; k < left; ++k) {
            ReflectionPoint& r = out[rest[k]];
            if (!finite(in[rest[k]])) {
                r = {};
                continue;
            }
            r = answers[k];
            if (inside) {
                const ReflectorMap::Sample under = map.sample(mapEye);
                r = {under.position,
                     under.normal,
                     0,
                     glm::length(moved[k] - mapEye),
                     ReflectionStatus::unreflected,
                     1};
            } else if (convex && !options.thorough) {
                if (r.status == ReflectionStatus::outOfSteps)
                    r.status =
                        r.residual < nearEnough ? ReflectionStatus::found : ReflectionStatus::unreflected;
            } else if (!convex) {
                r = settle(map, mapEye, moved[k], all.of(k));
            } else if (r.status == ReflectionStatus::outOfSteps) {
                r = searchThoroughly(map, mapEye, moved[k], options);
            }
            r.point = map.frame().fromMap(r.point);
            r.normal = map.frame().fromMapDirection(r.normal);
            r.path *= map.frame().scale;
        }
    }
}

}  // namespace reflection
#endif
