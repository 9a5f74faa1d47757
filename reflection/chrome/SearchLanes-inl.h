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

/// Farthest that one step may go along either axis of a face (a face is 2 wide): a Newton step from far away
/// is only a direction.
constexpr double longestStep = 0.5;

/// How far a point of the surface is from being the reflection point, and the step that Newton's method asks
/// for.
struct Judged {
    Num error;    ///< squared sine of the angle between bisector and normal; 2 - it beyond a right angle
    Num3 step;    ///< to add to the direction, which lies on the cube
    Num3 onCube;  ///< the direction (stretch taken out), brought to the cube
    Num3 point, normal;
    Num path;
};

/// `direction` has the stretch taken out, everything else is in the map's frame.
/// The step follows from f = (h . T1, h . T2), h = o + v the sum of the unit vectors to eye and vertex, T1,
/// T2 orthonormal and tangent: f is zero where the bisector is the normal. Its change along the surface is
/// that of h less (h . N) times that of N; what is left out (how the tangents turn in their plane) is f times
/// a rotation and vanishes at the solution, so the convergence stays quadratic.
HWY_INLINE Judged judge(const ReflectorMap& map, const Num3& eye, const Num3& vertex, const Num3& direction,
                        bool convex) {
    const Num one = num(1), zero = num(0);
    const OnCube at = onCube(direction);
    const Surface surface = surfaceAt(map, at);
    // Out of the face's frame; positions are stretched, normals the other way.
    const Stretch stretch(map);
    const Num3 g{at.s, at.t, one};
    const Num t = one / surface.q;
    const Num3 flat = t * g;
    const Num3 p = stretch.positions(at.axes.out(flat));
    const Num3 pS = stretch.positions(at.axes.out(t * (Num3{one, zero, zero} - surface.qS * flat)));
    const Num3 pT = stretch.positions(at.axes.out(t * (Num3{zero, one, zero} - surface.qT * flat)));
    const Num3 m = stretch.normals(at.axes.out(surface.m));
    const Num3 mS = stretch.normals(at.axes.out(surface.mS)), mT = stretch.normals(at.axes.out(surface.mT));
    const Num inverseLength = one / root(dot(m, m));
    const Num3 n = inverseLength * m;

    const Num3 toEye = eye - p, toVertex = vertex - p;
    const Num eyeDistance = root(dot(toEye, toEye)), vertexDistance = root(dot(toVertex, toVertex));
    const Num tiny = num(1e-300);
    const Num perEye = one / most(eyeDistance, tiny), perVertex = one / most(vertexDistance, tiny);
    const Num3 o = perEye * toEye, v = perVertex * toVertex;
    const Num3 h = o + v;
    const Num along = dot(h, n);

    const Num3 acrossS = pS - dot(pS, n) * n;
    const Num sLength = root(dot(acrossS, acrossS));
    const Num3 t1 = (one / most(sLength, tiny)) * acrossS;
    const Num3 t2 = cross(n, t1);
    const Num f1 = dot(h, t1), f2 = dot(h, t2);
    const Num hh = most(dot(h, h), tiny);
    const Num squaredSine = least(fma(f1, f1, f2 * f2) / hh, one);
    const Num error = choose(along > zero, squaredSine, num(2) - squaredSine);

    const auto change = [&](const Num3& slope, const Num3& normalSlope, Num& first, Num& second) {
        const Num3 turn = perEye * (dot(o, slope) * o - slope) + perVertex * (dot(v, slope) * v - slope);
        const Num bend = along * inverseLength;
        first = dot(t1, turn) - bend * dot(t1, normalSlope);
        second = dot(t2, turn) - bend * dot(t2, normalSlope);
    };
    Num j11, j21, j12, j22;
    change(pS, mS, j11, j21);
    change(pT, mT, j12, j22);
    const Num determinant = j11 * j22 - j12 * j21;
    Num ds = (j12 * f2 - j22 * f1) / determinant;
    Num dt = (j21 * f1 - j11 * f2) / determinant;

    // The paper's step: along the bisector, by less than the way to the solution if the piece is convex.
    // Taken where Newton's method has no answer or, on convex pieces, walks away from the bisector.
    const Num b11 = sLength, b12 = dot(t1, pT), b22 = dot(t2, pT);
    const Num reach = one / (perEye + perVertex + one);
    const Num plainT = reach * f2 / b22;
    const Num plainS = (reach * f1 - b12 * plainT) / b11;
    const Num progress = f1 * fma(b11, ds, b12 * dt) + f2 * (b22 * dt);
    MD newton = size(ds) + size(dt) < num(1e100);
    if (convex) newton = hn::And(newton, progress > zero);
    ds = choose(newton, ds, plainS);
    dt = choose(newton, dt, plainT);
    const Num largest = most(size(ds), size(dt));
    const Num shrink = choose(largest > num(longestStep), num(longestStep) / largest, one);
    const MD sane = largest < num(1e100);
    ds = choose(sane, shrink * ds, zero);
    dt = choose(sane, shrink * dt, zero);

    return {error, at.axes.out({ds, dt, zero}), at.axes.out(g), p, n, eyeDistance + vertexDistance};
}

HWY_INLINE Judged choose(MD m, const Judged& a, const Judged& b) {
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
HWY_INLINE MD surelyEnters(const ReflectorMap& map, const Num3& from, const Num3& to) {
    const Num3 along = to - from;
    const Num nearest = least(most(-dot(from, along) / most(dot(along, along), num(1e-300)), num(0)), num(1));
    const Num3 closest = from + nearest * along;
    return dot(closest, closest) < num(map.innerRadius() * map.innerRadius());
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
