// Compiled once for every instruction set that Highway knows on this architecture; the best is chosen at run
// time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "reflection/chrome/PathPerturbation.cpp"
#include <hwy/foreach_target.h>

#include "reflection/chrome/PathPerturbation.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "reflection/chrome/MapLanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace reflection {
namespace HWY_NAMESPACE {

/// Most lanes of doubles that any instruction set here has.
constexpr std::size_t mostLanes = 64 / sizeof(double);

/// Newton steps after which a vertex has no image; on smooth surfaces three or four are enough.
constexpr int mostSteps = 10;
/// How far from its ray a vertex may lie, in its distance from the reflection point: less than float
/// resolves.
constexpr double onRay = 1e-6;
/// Farthest that a step may go along a face (2 wide).
constexpr double longestStep = 0.25;

/// A reflected ray's point, l from the surface, and its derivatives, in the map's frame.
struct Path {
    Num3 point, sight, ray;  ///< of the surface, from the eye, onwards; unit
    Num3 sightS, sightT, pS, pT, a, b;
    Num facing, facingS, facingT, eyeDistance;
    Num3 onCube;
    FaceAxes axes;
};

HWY_INLINE Path pathAt(const ReflectorMap& map, const Stretch& stretch, const Num3& eye,
                       const Num3& direction, Num length) {
    const Num one = num(1), zero = num(0);
    const OnCube at = onCube(direction);
    const Surface surface = surfaceAt(map, at);
    const Num3 g{at.s, at.t, one};
    const Num t = one / surface.q;
    const Num3 flat = t * g;
    Path r;
    r.axes = at.axes;
    r.onCube = at.axes.out(g);
    r.point = stretch.positions(at.axes.out(flat));
    r.pS = stretch.positions(at.axes.out(t * (Num3{one, zero, zero} - surface.qS * flat)));
    r.pT = stretch.positions(at.axes.out(t * (Num3{zero, one, zero} - surface.qT * flat)));
    const Num3 m = stretch.normals(at.axes.out(surface.m));
    const Num3 mS = stretch.normals(at.axes.out(surface.mS)), mT = stretch.normals(at.axes.out(surface.mT));
    const Num perLength = one / root(dot(m, m));
    const Num3 n = perLength * m;
    const Num3 nS = perLength * (mS - dot(mS, n) * n), nT = perLength * (mT - dot(mT, n) * n);
    const Num3 from = r.point - eye;
    r.eyeDistance = most(root(dot(from, from)), num(1e-300));
    const Num perEye = one / r.eyeDistance;
    r.sight = perEye * from;
    r.sightS = perEye * (r.pS - dot(r.pS, r.sight) * r.sight);
    r.sightT = perEye * (r.pT - dot(r.pT, r.sight) * r.sight);
    r.facing = -dot(r.sight, n);
    r.facingS = -(dot(r.sightS, n) + dot(r.sight, nS));
    r.facingT = -(dot(r.sightT, n) + dot(r.sight, nT));
    const Num two = num(2);
    r.ray = r.sight + (two * r.facing) * n;
    r.a = r.pS + length * (r.sightS + two * (r.facingS * n + r.facing * nS));
    r.b = r.pT + length * (r.sightT + two * (r.facingT * n + r.facing * nT));
    return r;
}

/// Everything in the map's frame and units; images come out in the reflector's.
void perturbPackets(const ReflectorMap& map, const glm::dvec3& eye, const glm::dmat3& axes,
                    std::span<const glm::dvec3> vertices, std::span<const glm::dvec3> from,
                    std::span<PathImage> images) {
    const Doubles tag;
    const std::size_t lanes = hn::Lanes(tag);
    const Stretch stretch(map);
    const Num3 eyes = num3(eye);
    const MapFrame& frame = map.frame();
    const Num scale = num(frame.scale), perScale = num(1 / frame.scale);
    std::array<Num3, 3> turned;  // the map's axes, by rows
    for (int k = 0; k < 3; ++k)
        turned[static_cast<std::size_t>(k)] = num3({frame.axes[0][k], frame.axes[1][k], frame.axes[2][k]});
    const auto out = [&](const Num3& v) {
        return Num3{dot(turned[0], v), dot(turned[1], v), dot(turned[2], v)};
    };
    HWY_ALIGN std::array<double, 6 * mostLanes> in{};
    HWY_ALIGN std::array<double, 17 * mostLanes> results{};
    for (std::size_t first = 0; first < vertices.size(); first += lanes) {
        const std::size_t n = std::min(lanes, vertices.size() - first);
        for (std::size_t lane = 0; lane < lanes; ++lane) {
            const std::size_t k = first + std::min(lane, n - 1);
            for (int a = 0; a < 3; ++a) {
                in[static_cast<std::size_t>(a) * mostLanes + lane] = vertices[k][a];
                in[static_cast<std::size_t>(a + 3) * mostLanes + lane] = from[k][a];
            }
        }
        const auto load = [&](std::size_t row) { return Num{hn::Load(tag, in.data() + row * mostLanes)}; };
        const Num3 v{load(0), load(1), load(2)}, start{load(3), load(4), load(5)};
        const Num3 away = v - start;
        Num length = root(dot(away, away));
        Path path = pathAt(map, stretch, eyes, stretch.takeOut(start), length);
        const auto missOf = [&](const Path& p, Num l) { return v - p.point - l * p.ray; };
        Num3 miss = missOf(path, length);
        Num missed = dot(miss, miss);
        Num enough = num(onRay * onRay) * length * length;
        MD walking = missed > enough;
        for (int k = 0; k < mostSteps && !hn::AllFalse(tag, walking); ++k) {
            const Num3 across = cross(path.b, path.ray);
            const Num perVolume = num(1) / dot(path.a, across);
            Num ds = perVolume * dot(across, miss), dt = perVolume * dot(cross(path.ray, path.a), miss);
            const Num dl = perVolume * dot(cross(path.a, path.b), miss);
            const Num largest = most(size(ds), size(dt));
            const Num shrink = choose(largest > num(longestStep), num(longestStep) / largest, num(1));
            const Num3 step = path.axes.out({shrink * ds, shrink * dt, num(0)});
            const Num nextLength = length + shrink * dl;
            const Path next = pathAt(map, stretch, eyes, path.onCube + step, nextLength);
            const Num3 nextMiss = missOf(next, nextLength);
            // Without a safeguard: what does not come nearer in the end has no image.
            const auto keep = [&](Num& a, Num b) { a = choose(walking, b, a); };
            const auto keep3 = [&](Num3& a, const Num3& b) { a = choose(walking, b, a); };
            keep3(path.point, next.point), keep3(path.sight, next.sight), keep3(path.ray, next.ray);
            keep3(path.sightS, next.sightS), keep3(path.sightT, next.sightT);
            keep3(path.pS, next.pS), keep3(path.pT, next.pT), keep3(path.a, next.a), keep3(path.b, next.b);
            keep(path.facing, next.facing), keep(path.facingS, next.facingS);
            keep(path.facingT, next.facingT), keep(path.eyeDistance, next.eyeDistance);
            keep3(path.onCube, next.onCube);
            path.axes = onCube(path.onCube).axes;
            keep(length, nextLength);
            keep3(miss, nextMiss);
            missed = dot(miss, miss);
            enough = num(onRay * onRay) * length * length;
            walking = hn::And(walking, missed > enough);
        }
        const Num3 across = cross(path.b, path.ray);
        const Num volume = dot(path.a, across);
        const Num perVolume = num(1) / volume;
        const Num3 perS = perVolume * across, perT = perVolume * cross(path.ray, path.a),
                   perL = perVolume * cross(path.a, path.b);
        const auto put = [&](std::size_t row, Num x) {
            hn::Store(x.v, tag, results.data() + row * mostLanes);
        };
        const auto put3 = [&](std::size_t row, const Num3& x, Num w) {
            put(row, x.x), put(row + 1, x.y), put(row + 2, x.z), put(row + 3, w);
        };
        put3(0, scale * out((path.eyeDistance + length) * path.sight), path.facing);
        for (int k = 0; k < 3; ++k) {
            const Num3 along = num3(axes[k]);
            const Num ds = dot(perS, along), dt = dot(perT, along), dl = dot(perL, along);
            const Num3 moved = ds * (path.pS + length * path.sightS) + dt * (path.pT + length * path.sightT) +
                               dl * path.sight;
            put3(static_cast<std::size_t>(4 * k + 4), out(moved),
                 perScale * (ds * path.facingS + dt * path.facingT));
        }
        // Seen from the centre of a face its axes s, t, outwards are a left-handed system on all six.
        const MD sound = hn::And(hn::And(missed <= enough, length > num(0)), size(volume) > num(1e-12));
        put(16, choose(sound, choose(volume > num(0), num(1), num(-1)), num(0)));
        for (std::size_t lane = 0; lane < n; ++lane) {
            PathImage& image = images[first + lane];
            const auto get = [&](std::size_t row) {
                return static_cast<float>(results[row * mostLanes + lane]);
            };
            image.image = {get(0), get(1), get(2), get(3)};
            for (std::size_t k = 0; k < 3; ++k)
                image.by[k] = {get(4 * k + 4), get(4 * k + 5), get(4 * k + 6), get(4 * k + 7)};
            image.turn = static_cast<int>(get(16));
        }
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace reflection
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace reflection {

HWY_EXPORT(perturbPackets);

void perturbPaths(const ReflectorMap& map, const glm::dvec3& eye, const glm::dmat3& axes,
                  std::span<const glm::dvec3> vertices, std::span<const glm::dvec3> points,
                  std::span<PathImage> images) {
    constexpr std::size_t block = 256;
    std::array<glm::dvec3, block> moved, from;
    const MapFrame& frame = map.frame();
    glm::dmat3 turned;
    for (int k = 0; k < 3; ++k) turned[k] = frame.toMapDirection(axes[k]);
    for (std::size_t first = 0; first < vertices.size(); first += block) {
        const std::size_t n = std::min(block, vertices.size() - first);
        for (std::size_t k = 0; k < n; ++k) {
            moved[k] = frame.toMap(vertices[first + k]);
            from[k] = frame.toMap(points[first + k]);
        }
        HWY_DYNAMIC_DISPATCH(perturbPackets)
        (map, frame.toMap(eye), turned, std::span(moved).first(n), std::span(from).first(n),
         images.subspan(first, n));
    }
}

}  // namespace reflection
#endif
