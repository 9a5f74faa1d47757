// Compiled once for every instruction set that Highway knows on this architecture; the best is chosen at run
// time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "reflection/chrome/ReflectionSearch.cpp"
#include <hwy/foreach_target.h>

#include "reflection/chrome/ReflectionSearch.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "reflection/chrome/SearchLanes-inl.h"
#include "reflection/chrome/SearchStart-inl.h"
#include "reflection/chrome/ThoroughSearch.h"

HWY_BEFORE_NAMESPACE();
namespace reflection {
namespace HWY_NAMESPACE {

/// Most lanes of doubles that any instruction set here has.
constexpr std::size_t mostLanes = 64 / sizeof(double);  // 512 bits

/// A vector of points, filled and read one by one.
struct Points {
    HWY_ALIGN std::array<double, mostLanes> x{}, y{}, z{};

    void set(std::size_t lane, const glm::dvec3& p) { x[lane] = p.x, y[lane] = p.y, z[lane] = p.z; }
    glm::dvec3 get(std::size_t lane) const { return {x[lane], y[lane], z[lane]}; }
    HWY_INLINE Num3 load() const {
        const Doubles d;
        return {{hn::Load(d, x.data())}, {hn::Load(d, y.data())}, {hn::Load(d, z.data())}};
    }
    HWY_INLINE void store(const Num3& p) {
        const Doubles d;
        hn::Store(p.x.v, d, x.data());
        hn::Store(p.y.v, d, y.data());
        hn::Store(p.z.v, d, z.data());
    }
};

struct Values {
    HWY_ALIGN std::array<double, mostLanes> at{};
    HWY_INLINE void store(Num n) { hn::Store(n.v, Doubles(), at.data()); }
};

/// Cosine between normal and line of sight below which what has arrived is asked all the same: there rounding
/// tells.
constexpr double surelyFaces = 1e-3;

/// Convex pieces, first round: descents from the guesses, or where there are none (empty, or not a number)
/// from a start of its own. A point before whose tangent plane eye and vertex both lie shows that a convex
/// body does not stand between them, so what arrives is answered. Returns how many are not; which goes to
/// `rest`. Everything in the map's frame and units.
std::size_t searchQuickly(const ReflectorMap& map, const glm::dvec3& eye,
                          std::span<const glm::dvec3> vertices, std::span<const glm::dvec3> guesses,
                          std::span<ReflectionPoint> points, std::span<std::uint32_t> rest,
                          const SearchOptions& options, int lookupsEach) {
    const Doubles tag;
    const std::size_t lanes = hn::Lanes(tag);
    const EyeSide eyeSide(map, eye);
    const Num3 eyes = num3(eye);
    const Stretch stretch(map);
    SearchOptions quick = options;
    quick.lookups = std::min(options.lookups, lookupsEach);
    std::size_t left = 0;
    for (std::size_t first = 0; first < vertices.size(); first += lanes) {
        const std::size_t n = std::min(lanes, vertices.size() - first);
        Points vertex;
        for (std::size_t k = 0; k < lanes; ++k) vertex.set(k, vertices[first + std::min(k, n - 1)]);
        const Num3 v = vertex.load();
        Num3 start;
        MD own = num(0) < num(1);
        if (!guesses.empty()) {
            Points guess;
            for (std::size_t k = 0; k < lanes; ++k) guess.set(k, guesses[first + std::min(k, n - 1)]);
            start = stretch.takeOut(guess.load());
            own = hn::Not(dot(start, start) > num(0));
        }
        if (!hn::AllFalse(tag, own)) {
            const Num3 made = startFor(map, eyeSide, v);
            start = guesses.empty() ? made : choose(own, made, start);
        }
        const MD open = hn::Not(surelyEnters(map, stretch.takeOut(eyes), stretch.takeOut(v)));
        const Descent descent = descend(map, eyes, v, judge(map, eyes, v, start, true), open, quick, true);
        Points at, up;
        Values path, error, lookups;
        const Num3 toEye = eyes - descent.best.point, toVertex = v - descent.best.point;
        at.store(descent.best.point);
        up.store(descent.best.normal);
        path.store(root(dot(toEye, toEye)) + root(dot(toVertex, toVertex)));
        const MD faces = dot(toEye, descent.best.normal) > num(surelyFaces) * root(dot(toEye, toEye));
        error.store(choose(hn::And(open, faces), descent.best.error, num(2)));
        lookups.store(descent.lookups);
        for (std::size_t k = 0; k < n; ++k) {
            ReflectionPoint& r = points[first + k];
            r.lookups = static_cast<std::uint8_t>(r.lookups + lookups.at[k]);
            r.point = at.get(k);
            // The sine is the angle to 1e-21.
            r.residual = std::sqrt(error.at[k]);
            if (!(r.residual <= options.tolerance)) {
                rest[left++] = static_cast<std::uint32_t>(first + k);
                continue;
            }
            r.normal = up.get(k);
            r.path = path.at[k];
            r.status = map.covered(r.point) ? ReflectionStatus::found : ReflectionStatus::unreflected;
        }
    }
    return left;
}

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
    for (std::size_t first = 0; first < vertices.size(); first += lanes) {
        const std::size_t n = std::min(lanes, vertices.size() - first);
        Points vertex;
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
        const Descent descent = descend(map, eyes, v, judged, visible, options, true);

        Num3 point = descent.best.point, normal = descent.best.normal;
        if (!hn::AllFalse(tag, entry.enters)) {
            const Num3 met = eyes + entry.at * (v - eyes);
            const OnCube at = onCube(stretch.takeOut(met));
            const Num3 m = stretch.normals(at.axes.out(surfaceAt(map, at).m));
            point = choose(entry.enters, met, point);
            normal = choose(entry.enters, (num(1) / root(dot(m, m))) * m, normal);
        }
        Points at, up, again;
        Values path, error, lookups, hidden, retried;
        MD failed = hn::And(visible, descent.best.error > num(options.tolerance * options.tolerance));
        if (!map.coveredNormalTable().empty() && !hn::AllFalse(tag, failed)) {
            // What does not arrive has mostly run into the closing surface's creases. From the part itself a
            // descent reaches the reflection point that is there, or leaves the part as well.
            const Descent other = descend(
                map, eyes, v, judge(map, eyes, v, startFromTable(map.coveredNormalTable(), eyeSide, v), true),
                failed, options, true);
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
        Points start, point, normal;
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

/// Residual, radians, beyond which a vertex that has not arrived is asked at once whether it is hidden.
constexpr double farOff = 0.3;

/// Lookups of the first two descents, before it is known whether the reflector hides the vertex: what has
/// arrived by then needs no test. Most arrive in the first, from near by in two.
constexpr int firstLookups = 4, nextLookups = 6;
/// Where the part has a rim there is one descent: its steps are the graphics card's, and so is the side of
/// the rim on which a point within the tolerance of it ends.
constexpr int onlyLookups = 7;

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
    std::array<glm::dvec3, block> moved, guessed, others;
    std::array<std::uint32_t, block> rest;
    std::array<ReflectionPoint, block> answers;
    for (std::size_t first = 0; first < vertices.size(); first += block) {
        const std::size_t n = std::min(block, vertices.size() - first);
        const std::span<ReflectionPoint> out = points.subspan(first, n);
        for (std::size_t k = 0; k < n; ++k) {
            const glm::dvec3& v = vertices[first + k];
            moved[k] = finite(v) ? map.frame().toMap(v) : mapEye;
        }
        if (convex && !inside) {
            std::span<const glm::dvec3> from;
            if (!guesses.empty()) {
                for (std::size_t k = 0; k < n; ++k) guessed[k] = map.frame().toMap(guesses[first + k]);
                from = std::span(guessed).first(n);
            }
            for (ReflectionPoint& r : out) r.lookups = 0;
            std::size_t left =
                HWY_DYNAMIC_DISPATCH(searchQuickly)(map, mapEye, std::span(moved).first(n), from, out, rest,
                                                    options, map.closed() ? firstLookups : onlyLookups);
            // Those that are on their way go on together, so that packets do not wait for their last vertex;
            // the others are hidden, most of them.
            std::array<std::uint32_t, block> going, stayed;
            std::size_t go = 0, stay = 0;
            for (std::size_t k = 0; k < left; ++k) {
                const ReflectionPoint& r = out[rest[k]];
                if (map.closed() && r.residual < farOff) {
                    others[go] = moved[rest[k]];
                    guessed[go] = r.point;
                    answers[go].lookups = r.lookups;
                    going[go++] = rest[k];
                } else {
                    stayed[stay++] = rest[k];
                }
            }
            if (go > 0) {
                left = HWY_DYNAMIC_DISPATCH(searchQuickly)(
                    map, mapEye, std::span(others).first(go), std::span(guessed).first(go),
                    std::span(answers).first(go), rest, options, nextLookups);
                for (std::size_t k = 0; k < go; ++k) out[going[k]] = answers[k];
                for (std::size_t k = 0; k < left; ++k) stayed[stay++] = going[rest[k]];
            }
            for (std::size_t k = 0; k < stay; ++k) {
                others[k] = moved[stayed[k]];
                answers[k].lookups = out[stayed[k]].lookups;
            }
            HWY_DYNAMIC_DISPATCH(searchPackets)
            (map, mapEye, std::span(others).first(stay), std::span(answers).first(stay), options);
            for (std::size_t k = 0; k < stay; ++k) out[stayed[k]] = answers[k];
        }
        for (std::size_t k = 0; k < n; ++k) {
            ReflectionPoint& r = out[k];
            if (!finite(vertices[first + k])) {
                r = {};
                continue;
            }
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
            } else if (!convex || r.status == ReflectionStatus::outOfSteps) {
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
