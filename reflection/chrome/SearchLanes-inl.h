// Per-instruction-set part of the reflection-point search: Newton steps and the test for hidden vertices, for
// a vector of vertices. Included once per target by ReflectionSearch.cpp.
#if defined(REFLECTION_CHROME_SEARCH_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef REFLECTION_CHROME_SEARCH_LANES_INL_H
#undef REFLECTION_CHROME_SEARCH_LANES_INL_H
#else
#define REFLECTION_CHROME_SEARCH_LANES_INL_H
#endif

#include "reflection/chrome/MapLanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace reflection {
namespace HWY_NAMESPACE {

/// Most lanes of doubles that any instruction set here has.
constexpr std::size_t mostDoubles = 64 / sizeof(double);  // 512 bits

/// A vector of points, filled and read one by one.
struct Values3 {
    HWY_ALIGN std::array<double, mostDoubles> x{}, y{}, z{};

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
    HWY_ALIGN std::array<double, mostDoubles> at{};
    HWY_INLINE void store(Num n) { hn::Store(n.v, Doubles(), at.data()); }
};

/// Farthest that one step may go along either axis of a face (a face is 2 wide): a Newton step from far away
/// is only a direction.
constexpr double longestStep = 0.5;

/// How far a point of the surface is from being the reflection point, and the step that Newton's method asks
/// for.
template <class T>
struct JudgedOf {
    Real<T> error;    ///< squared sine of the angle between bisector and normal; 2 - it beyond a right angle
    Real3<T> step;    ///< to add to the direction, which lies on the cube
    Real3<T> onCube;  ///< the direction (stretch taken out), brought to the cube
    Real3<T> point, normal;
    Real<T> path;
};
using Judged = JudgedOf<double>;

/// What eye and vertex see at a point of the surface.
template <class T>
struct Sight {
    Real3<T> o, v, h, across;  ///< unit vectors to eye and vertex, their sum, and its part along the surface
    Real<T> perEye, perVertex, path, along;  ///< `along`: h's part along the normal
    Real<T> error;

    HWY_INLINE Sight(const Real3<T>& eye, const Real3<T>& vertex, const Real3<T>& p, const Real3<T>& n) {
        const Real<T> one = real<T>(1), zero = real<T>(0), tiny = real<T>(tinyOf<T>);
        const Real3<T> toEye = eye - p, toVertex = vertex - p;
        const Real<T> eyeDistance = root(dot(toEye, toEye)), vertexDistance = root(dot(toVertex, toVertex));
        perEye = one / most(eyeDistance, tiny), perVertex = one / most(vertexDistance, tiny);
        o = perEye * toEye, v = perVertex * toVertex;
        h = o + v;
        along = dot(h, n);
        across = h - along * n;
        const Real<T> squaredSine = least(dot(across, across) / most(dot(h, h), tiny), one);
        error = choose(along > zero, squaredSine, real<T>(2) - squaredSine);
        path = eyeDistance + vertexDistance;
    }
};

/// `direction` has the stretch taken out, everything else is in the map's frame.
/// The step follows from f = (h . A, h . B), h = o + v the sum of the unit vectors to eye and vertex, A and B
/// the parts along the surface of its change with s and t: f is zero where the bisector is the normal. Its
/// change along the surface is that of h less (h . N) times that of N; what is left out (how A and B change)
/// is h's part along the surface times a matrix and vanishes at the solution, so the convergence stays
/// quadratic.
template <class T>
HWY_INLINE JudgedOf<T> judge(const ReflectorMap& map, const Real3<T>& eye, const Real3<T>& vertex,
                             const Real3<T>& direction, bool convex) {
    const LanesOf<T> tag;
    const Real<T> one = real<T>(1), zero = real<T>(0);
    const double endless = sizeof(T) == 8 ? 1e100 : 1e30;
    const OnCubeOf<T> at = onCube(direction);
    const SurfaceOf<T> surface = surfaceAt(map, at);
    // Out of the face's frame; positions are stretched, normals the other way.
    const StretchOf<T> stretch(map);
    const Real3<T> g{at.s, at.t, one};
    const Real<T> t = one / surface.q;
    const Real3<T> flat = t * g;
    const Real3<T> p = stretch.positions(at.axes.out(flat));
    const Real3<T> pS = stretch.positions(at.axes.out(t * (Real3<T>{one, zero, zero} - surface.qS * flat)));
    const Real3<T> pT = stretch.positions(at.axes.out(t * (Real3<T>{zero, one, zero} - surface.qT * flat)));
    const Real3<T> m = stretch.normals(at.axes.out(surface.m));
    const Real3<T> mS = stretch.normals(at.axes.out(surface.mS)),
                   mT = stretch.normals(at.axes.out(surface.mT));
    const Real<T> inverseLength = one / root(dot(m, m));
    const Real3<T> n = inverseLength * m;
    const Sight<T> sight(eye, vertex, p, n);

    const Real3<T> a = pS - dot(pS, n) * n, b = pT - dot(pT, n) * n;
    const Real<T> f1 = dot(sight.across, a), f2 = dot(sight.across, b);
    const Real<T> bend = sight.along * inverseLength;
    const auto change = [&](const Real3<T>& slope, const Real3<T>& normalSlope) {
        return sight.perEye * (dot(sight.o, slope) * sight.o - slope) +
               sight.perVertex * (dot(sight.v, slope) * sight.v - slope) - bend * normalSlope;
    };
    const Real3<T> turnS = change(pS, mS), turnT = change(pT, mT);
    const Real<T> j11 = dot(a, turnS), j21 = dot(b, turnS), j12 = dot(a, turnT), j22 = dot(b, turnT);
    const Real<T> perDeterminant = one / (j11 * j22 - j12 * j21);
    Real<T> ds = perDeterminant * (j12 * f2 - j22 * f1);
    Real<T> dt = perDeterminant * (j21 * f1 - j11 * f2);

    // The paper's step: along the bisector, by less than the way to the solution if the piece is convex.
    // Taken where Newton's method has no answer or, on convex pieces, walks away from the bisector.
    MaskOf<T> newton = size(ds) + size(dt) < real<T>(endless);
    if (convex) newton = hn::And(newton, f1 * ds + f2 * dt > zero);
    if (!hn::AllTrue(tag, newton)) {
        const Real<T> aa = dot(a, a), ab = dot(a, b), bb = dot(b, b);
        const Real<T> reach = one / ((sight.perEye + sight.perVertex + one) * (aa * bb - ab * ab));
        ds = choose(newton, ds, reach * (bb * f1 - ab * f2));
        dt = choose(newton, dt, reach * (aa * f2 - ab * f1));
    }
    const Real<T> largest = most(size(ds), size(dt));
    const Real<T> shrink = choose(largest > real<T>(longestStep), real<T>(longestStep) / largest, one);
    const MaskOf<T> sane = largest < real<T>(endless);
    ds = choose(sane, shrink * ds, zero);
    dt = choose(sane, shrink * dt, zero);

    return {sight.error, at.axes.out({ds, dt, zero}), at.axes.out(g), p, n, sight.path};
}

/// The same at the end of the way: no step.
template <class T>
HWY_INLINE JudgedOf<T> judgeEnd(const ReflectorMap& map, const Real3<T>& eye, const Real3<T>& vertex,
                                const Real3<T>& direction) {
    const Real<T> one = real<T>(1), zero = real<T>(0);
    const OnCubeOf<T> at = onCube(direction);
    Real<T> q;
    Real3<T> blended;
    placeAt(map, at, q, blended);
    const StretchOf<T> stretch(map);
    const Real3<T> g = at.axes.out({at.s, at.t, one});
    const Real3<T> p = stretch.positions((one / q) * g);
    const Real3<T> m = stretch.normals(at.axes.out(blended));
    const Real3<T> n = (one / root(dot(m, m))) * m;
    const Sight<T> sight(eye, vertex, p, n);
    return {sight.error, {zero, zero, zero}, g, p, n, sight.path};
}

template <class T>
HWY_INLINE JudgedOf<T> choose(MaskOf<T> m, const JudgedOf<T>& a, const JudgedOf<T>& b) {
    return {choose(m, a.error, b.error), choose(m, a.step, b.step),     choose(m, a.onCube, b.onCube),
            choose(m, a.point, b.point), choose(m, a.normal, b.normal), choose(m, a.path, b.path)};
}

struct Descent {
    Judged best;
    Num lookups;
};

/// Halvings in a row after which a descent ends: a step to a 1,000th that is still no better runs into a
/// crease of the closing surface or, on a concave piece, into a least error that is none.
constexpr double mostHalvings = 10;

/// Steps from the given starts until the error is small enough, the steps vanish, or the lookups are used up.
HWY_INLINE Descent descend(const ReflectorMap& map, const Num3& eye, const Num3& vertex, const Judged& start,
                           MD active, const SearchOptions& options, bool convex) {
    const Doubles tag;
    const Num enough = num(options.tolerance * options.tolerance);
    // A step of this size moves the point by less than the spacing of doubles.
    const Num still = num(1e-16);
    Descent result;
    result.best = start;
    result.lookups = num(1);
    MD walking = hn::And(active, result.best.error > enough);
    Num3 step = result.best.step;
    Num halvings = num(0);
    for (int k = 1; k < options.lookups && !hn::AllFalse(tag, walking); ++k) {
        const Judged next = judge(map, eye, vertex, result.best.onCube + step, convex);
        result.lookups = choose(walking, result.lookups + num(1), result.lookups);
        const MD better = hn::And(walking, next.error < result.best.error);
        result.best = choose(better, next, result.best);
        step = choose(better, next.step, num(0.5) * step);
        halvings = choose(better, num(0), halvings + num(1));
        walking = hn::And(walking, halvings < num(mostHalvings));
        const MD moves = most(size(step.x), most(size(step.y), size(step.z))) > still;
        walking = hn::And(walking, hn::And(moves, result.best.error > enough));
    }
    return result;
}

/// Where lines from outside enter the surface. Ends with the stretch taken out.
struct Entry {
    MD enters;  ///< the segment meets the inside
    Num at;     ///< share of the way; where it does not enter, its nearest point
};

/// Segments (ends with the stretch taken out) that come nearer to the centre than any point of the surface.
template <class T>
HWY_INLINE MaskOf<T> surelyEnters(const ReflectorMap& map, const Real3<T>& from, const Real3<T>& to) {
    const Real3<T> along = to - from;
    const Real<T> nearest =
        least(most(-dot(from, along) / most(dot(along, along), real<T>(tinyOf<T>)), real<T>(0)), real<T>(1));
    const Real3<T> closest = from + nearest * along;
    return dot(closest, closest) < real<T>(map.innerRadius() * map.innerRadius());
}

/// Along a line the gauge of a convex body is convex: the tangents at both ends of a bracket meet below its
/// least value, which either shows that the line passes outside or gives the next point of the bracket. From
/// the outside Newton's steps on a convex function then reach the entry without passing it.
HWY_INLINE Entry enter(const ReflectorMap& map, const Num3& from, const Num3& to, MD active) {
    const Doubles tag;
    const Num one = num(1), zero = num(0);
    const Num3 along = to - from;
    const auto pointAt = [&](Num t) { return from + t * along; };
    const Num nearest = least(most(-dot(from, along) / most(dot(along, along), num(1e-300)), zero), one);
    const Num3 closest = pointAt(nearest);
    const Num squared = dot(closest, closest);
    Entry result;
    const MD surelyIn = squared < num(map.innerRadius() * map.innerRadius());
    const MD surelyOut = squared > num(map.outerRadius() * map.outerRadius());
    result.enters = hn::And(active, surelyIn);
    result.at = nearest;
    MD open = hn::AndNot(hn::Or(surelyIn, surelyOut), active);
    if (!hn::AllFalse(tag, open)) {
        Num lowSlope, highSlope, low = zero, high = one;
        Num lowGauge = gaugeAt(map, from, along, lowSlope), highGauge = gaugeAt(map, to, along, highSlope);
        for (int k = 0; k < 24 && !hn::AllFalse(tag, open); ++k) {
            // Still falling at the end: the end is the deepest point. Rising at the start: it never comes
            // nearer.
            const MD falling = hn::And(open, highSlope <= zero);
            result.enters = hn::Or(result.enters, hn::And(falling, highGauge < one));
            result.at = choose(falling, high, result.at);
            open = hn::AndNot(falling, open);
            const MD rising = hn::And(open, lowSlope >= zero);
            result.at = choose(rising, low, result.at);
            open = hn::AndNot(rising, open);
            const Num t = least(
                most((lowGauge - highGauge + highSlope * high - lowSlope * low) / (highSlope - lowSlope),
                     low),
                high);
            result.at = choose(open, t, result.at);
            const MD out = lowGauge + lowSlope * (t - low) >= one;
            open = hn::AndNot(out, open);
            open = hn::And(open, high - low > num(1e-14));
            if (hn::AllFalse(tag, open)) break;
            Num slope;
            const Num gauge = gaugeAt(map, pointAt(t), along, slope);
            const MD in = hn::And(open, gauge < one);
            result.enters = hn::Or(result.enters, in);
            open = hn::AndNot(in, open);
            const MD before = slope < zero;
            low = choose(before, t, low), lowGauge = choose(before, gauge, lowGauge);
            lowSlope = choose(before, slope, lowSlope);
            high = choose(before, high, t), highGauge = choose(before, highGauge, gauge);
            highSlope = choose(before, highSlope, slope);
        }
    }
    MD entering = result.enters;
    if (!hn::AllFalse(tag, entering)) {
        Num outside = zero, inside = result.at, t = zero;
        for (int k = 0; k < 60 && !hn::AllFalse(tag, entering); ++k) {
            Num slope;
            const Num gauge = gaugeAt(map, pointAt(t), along, slope);
            const MD isOut = gauge >= one;
            outside = choose(isOut, t, outside);
            inside = choose(isOut, inside, t);
            result.at = choose(entering, t, result.at);
            entering =
                hn::And(entering, hn::And(size(gauge - one) > num(1e-13), inside - outside > num(1e-16)));
            const Num newton = t + (one - gauge) / slope;
            const MD inBracket = hn::And(newton > outside, newton < inside);
            t = choose(inBracket, newton, num(0.5) * (outside + inside));
        }
    }
    return result;
}

}  // namespace HWY_NAMESPACE
}  // namespace reflection
HWY_AFTER_NAMESPACE();
#endif
