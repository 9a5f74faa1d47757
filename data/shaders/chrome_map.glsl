// A reflector map on the GPU: lookups, gauge, Newton's step. What reflection/chrome/MapLanes-inl.h, SearchLanes-inl.h
// and SearchStart-inl.h do, in the precision that `REAL_IS_DOUBLE` chooses: whoever changes one changes the other.
#ifdef REAL_IS_DOUBLE
#define real double
#define real2 dvec2
#define real3 dvec3
const real tiny = 1e-100lf;
#else
#define real float
#define real2 vec2
#define real3 vec3
/// Nothing nearer than this is told apart from nothing: float's spacing at the surface is 6e-8.
const real tiny = 1e-9;
#endif

/// What all vertices of a search share. std140; ChromeSearch.cpp's SearchBlock.
layout(std140, binding = 0) uniform SearchBlock {
    dvec4 axisX, axisY, axisZ;  // the map's axes in the reflector's frame; w of the first: metres per unit
    dvec4 eyeInMap;             // w: its gauge
    dvec4 eyeUnit;              // from the centre
    dvec4 eyeFoot, eyeNormal;   // the surface under the eye
    dvec4 stretchInMap;
    vec2 radii;                 // inner, outer, stretch taken out
    uint cells;
    uint vertexCount;
    uint concave;
    uint eyeInside;
    uint normalSide;
    uint hasCovered;  // a second table, of the points that the part itself covers
};

layout(std430, binding = 0) readonly restrict buffer Corners { vec4 corners[]; };
/// Four corners' coverage in each.
layout(std430, binding = 1) readonly restrict buffer Coverage { uint coverage[]; };
layout(std430, binding = 2) readonly restrict buffer NormalTable { vec4 directionOfNormal[]; };

const uint statusFound = 0u, statusHidden = 1u, statusUnreflected = 2u, statusUnsettled = 3u, statusInvalid = 4u;

real squared(real x) { return x * x; }
real3 stretchBy() { return real3(stretchInMap.xyz); }

struct OnCube {
    real3 major, sAxis, tAxis;
    real s, t;
    real largest;  // of the direction's components
    uint face;
};

OnCube onCube(real3 d) {
    real3 a = abs(d);
    OnCube at;
    bool isX = a.x >= a.y && a.x >= a.z;
    bool isY = !isX && a.y >= a.z;
    bool negative = (isX ? d.x : isY ? d.y : d.z) < real(0);
    real sign = negative ? real(-1) : real(1);
    at.face = (isX ? 0u : isY ? 2u : 4u) + (negative ? 1u : 0u);
    at.major = isX ? real3(sign, 0, 0) : isY ? real3(0, sign, 0) : real3(0, 0, sign);
    at.sAxis = isX ? real3(0, 0, -sign) : isY ? real3(1, 0, 0) : real3(sign, 0, 0);
    at.tAxis = isY ? real3(0, 0, sign) : real3(0, -1, 0);
    at.largest = max(max(a.x, max(a.y, a.z)), real(1e-30));
    at.s = dot(at.sAxis, d) / at.largest;
    at.t = dot(at.tAxis, d) / at.largest;
    return at;
}

real3 intoFace(OnCube at, real3 p) { return real3(dot(at.sAxis, p), dot(at.tAxis, p), dot(at.major, p)); }
real3 outOfFace(OnCube at, real3 p) { return p.x * at.sAxis + p.y * at.tAxis + p.z * at.major; }

/// The map's surface at (s, t) of a face, in the face's frame.
struct Surface {
    real q, qS, qT;    // reciprocal distance along (s, t, 1) and its slopes
    real3 m, mS, mT;   // normal before it is brought to unit length, and its slopes
};

uint cellOf(real x, out real fraction) {
    real scaled = (x + real(1)) * real(0.5) * real(cells);
    real whole = clamp(floor(scaled), real(0), real(cells - 1u));
    fraction = scaled - whole;
    return uint(whole);
}

uint cornerIndex(uint face, uint column, uint row) { return (face * (cells + 1u) + row) * (cells + 1u) + column; }

Surface surfaceAt(OnCube at) {
    real u, v;
    uint column = cellOf(at.s, u), row = cellOf(at.t, v);
    real perCell = real(0.5) * real(cells), cellSize = real(2) / real(cells);
    real s0 = real(column) * cellSize - real(1), t0 = real(row) * cellSize - real(1);
    uint first = cornerIndex(at.face, column, row);
    Surface r = Surface(real(0), real(0), real(0), real3(0), real3(0), real3(0));
    for (uint k = 0u; k < 4u; ++k) {
        uint right = k & 1u, low = k >> 1u;
        vec4 corner = corners[first + right + low * (cells + 1u)];
        real3 m = intoFace(at, real3(corner.xyz));
        real halfC = real(0.5) * real(corner.w);
        real wu = right != 0u ? u : real(1) - u, wv = low != 0u ? v : real(1) - v;
        real w = wu * wv;
        real wS = right != 0u ? perCell * wv : -perCell * wv;
        real wT = low != 0u ? perCell * wu : -perCell * wu;
        real sSum = at.s + s0 + (right != 0u ? cellSize : real(0));
        real tSum = at.t + t0 + (low != 0u ? cellSize : real(0));
        real predicted = halfC * (m.x * sSum + m.y * tSum + real(2) * m.z);
        r.q += w * predicted;
        r.qS += wS * predicted + w * halfC * m.x;
        r.qT += wT * predicted + w * halfC * m.y;
        r.m += w * m;
        r.mS += wS * m;
        r.mT += wT * m;
    }
    return r;
}

/// Share of a direction's four corners (stretch taken out) that the part itself covers, as they are blended.
real coverageAt(real3 direction) {
    OnCube at = onCube(direction);
    real u, v;
    uint column = cellOf(at.s, u), row = cellOf(at.t, v);
    uint first = cornerIndex(at.face, column, row);
    real sum = real(0);
    for (uint k = 0u; k < 4u; ++k) {
        uint right = k & 1u, low = k >> 1u;
        uint index = first + right + low * (cells + 1u);
        real w = (right != 0u ? u : real(1) - u) * (low != 0u ? v : real(1) - v);
        if (((coverage[index >> 2u] >> (8u * (index & 3u))) & 255u) != 0u) sum += w;
    }
    return sum;
}

/// Gauge of a point, stretch taken out (below 1 inside), and its change along a direction.
real gaugeAt(real3 p, real3 along, out real slope) {
    OnCube at = onCube(p);
    Surface surface = surfaceAt(at);
    real3 d = intoFace(at, along);
    slope = surface.qS * d.x + surface.qT * d.y + (surface.q - at.s * surface.qS - at.t * surface.qT) * d.z;
    return at.largest * surface.q;
}

/// Direction, stretch taken out, where a table finds a normal; 1: the one of points that the part itself covers.
real3 startOfNormal(real3 normal, uint table) {
    OnCube at = onCube(normal);
    real side = real(normalSide);
    uint column = uint(clamp(floor((at.s + real(1)) * real(0.5) * side), real(0), side - real(1)));
    uint row = uint(clamp(floor((at.t + real(1)) * real(0.5) * side), real(0), side - real(1)));
    return real3(directionOfNormal[((6u * table + at.face) * normalSide + row) * normalSide + column].xyz);
}

/// SearchLanes-inl.h's Judged. `uncertain`: radians, seen from the eye, by which the point moves for each unit that h's
/// part along the surface is off.
struct Judged {
    real error;
    real3 step, place;
    real3 point, normal;
    real path;
    real offBy;      // size of h's part along the surface
    real uncertain;
    real closeness;  // perEye + perVertex
    real along;      // h along the normal: twice the cosine of the angle of incidence
};

const real longestStep = real(0.5);

Judged judge(real3 eye, real3 vertex, real3 direction, bool convex) {
    OnCube at = onCube(direction);
    Surface surface = surfaceAt(at);
    real3 by = stretchBy();
    real3 g = real3(at.s, at.t, 1);
    real t = real(1) / surface.q;
    real3 flatPoint = t * g;
    real3 p = by * outOfFace(at, flatPoint);
    real3 pS = by * outOfFace(at, t * (real3(1, 0, 0) - surface.qS * flatPoint));
    real3 pT = by * outOfFace(at, t * (real3(0, 1, 0) - surface.qT * flatPoint));
    real3 m = outOfFace(at, surface.m) / by;
    real3 mS = outOfFace(at, surface.mS) / by, mT = outOfFace(at, surface.mT) / by;
    real inverseLength = real(1) / sqrt(dot(m, m));
    real3 n = inverseLength * m;

    real3 toEye = eye - p, toVertex = vertex - p;
    real eyeDistance = sqrt(dot(toEye, toEye)), vertexDistance = sqrt(dot(toVertex, toVertex));
    real perEye = real(1) / max(eyeDistance, tiny), perVertex = real(1) / max(vertexDistance, tiny);
    real3 o = perEye * toEye, v = perVertex * toVertex;
    real3 h = o + v;
    real along = dot(h, n);

    real3 acrossS = pS - dot(pS, n) * n;
    real sLength = sqrt(dot(acrossS, acrossS));
    real3 t1 = acrossS / max(sLength, tiny);
    real3 t2 = cross(n, t1);
    real f1 = dot(h, t1), f2 = dot(h, t2);
    real ff = f1 * f1 + f2 * f2;
    real squaredSine = min(ff / max(dot(h, h), tiny * tiny), real(1));
    Judged r;
    r.error = along > real(0) ? squaredSine : real(2) - squaredSine;

    real bend = along * inverseLength;
    real3 turnS = perEye * (dot(o, pS) * o - pS) + perVertex * (dot(v, pS) * v - pS) - bend * mS;
    real3 turnT = perEye * (dot(o, pT) * o - pT) + perVertex * (dot(v, pT) * v - pT) - bend * mT;
    real j11 = dot(t1, turnS), j21 = dot(t2, turnS), j12 = dot(t1, turnT), j22 = dot(t2, turnT);
    real perDeterminant = real(1) / (j11 * j22 - j12 * j21);
    // How the place answers to a change of f1 and of f2.
    real2 byFirst = perDeterminant * real2(-j22, j21), bySecond = perDeterminant * real2(j12, -j11);
    real ds = f1 * byFirst.x + f2 * bySecond.x, dt = f1 * byFirst.y + f2 * bySecond.y;

    real b12 = dot(t1, pT), b22 = dot(t2, pT);
    real reach = real(1) / (perEye + perVertex + real(1));
    real plainT = reach * f2 / b22;
    real plainS = (reach * f1 - b12 * plainT) / sLength;
    real progress = f1 * (sLength * ds + b12 * dt) + f2 * (b22 * dt);
    bool newton = abs(ds) + abs(dt) < real(1e30) && (!convex || progress > real(0));
    if (!newton) {
        ds = plainS;
        dt = plainT;
    }
    real largest = max(abs(ds), abs(dt));
    bool sane = largest < real(1e30);
    real shrink = largest > longestStep ? longestStep / largest : real(1);
    r.step = sane ? outOfFace(at, real3(shrink * ds, shrink * dt, 0)) : real3(0);
    r.place = outOfFace(at, g);
    r.point = p;
    r.normal = n;
    r.path = eyeDistance + vertexDistance;
    r.offBy = sqrt(ff);
    real3 moves1 = byFirst.x * pS + byFirst.y * pT, moves2 = bySecond.x * pS + bySecond.y * pT;
    r.uncertain = perEye * sqrt(max(dot(moves1, moves1) - squared(dot(moves1, o)) + dot(moves2, moves2) -
                                        squared(dot(moves2, o)),
                                    real(0)));
    r.closeness = perEye + perVertex;
    r.along = along;
    return r;
}

/// SearchLanes-inl.h's mostHalvings.
const int mostHalvings = 10;

/// Newton's steps, each kept only where the angle shrinks and halved otherwise, until `enough` (a squared sine), until
/// steps are below `still`, or to the end of the lookups.
Judged descend(real3 eye, real3 vertex, Judged start, bool convex, real enough, real still, int lookups) {
    Judged best = start;
    real3 step = best.step;
    int halvings = 0;
    for (int k = 1; k < lookups && best.error > enough && !(convex && halvings >= mostHalvings); ++k) {
        Judged next = judge(eye, vertex, best.place + step, convex);
        if (next.error < best.error) {
            best = next;
            step = next.step;
            halvings = 0;
        } else {
            step *= real(0.5);
            ++halvings;
        }
        if (!(max(abs(step.x), max(abs(step.y), abs(step.z))) > still)) break;
    }
    return best;
}

#ifdef REAL_IS_DOUBLE
/// Decisions of the test for hidden vertices are certain.
real doubtFor(real3 from, real3 to) { return real(0); }
const real narrow = 1e-14lf, onSurface = 1e-13lf, narrowEntry = 1e-16lf;
#else
/// Rounding of a gauge at a point of the line: sixteen roundings (six of the lookup's, four of the position's, the rest
/// for sums of four corners), the position's as large as the line's ends are far.
real doubtFor(real3 from, real3 to) {
    return real(16 * 6e-8) * (real(1) + min(sqrt(dot(from, from)), sqrt(dot(to - from, to - from))));
}
const real narrow = 1e-7, onSurface = 1e-6, narrowEntry = 1e-7;
#endif

/// Where a line from outside enters the surface. Ends with the stretch taken out.
struct Entry {
    bool enters;  // the segment meets the inside
    bool sure;
    real at;      // share of the way; where it does not enter, its nearest point
    real slope;   // of the gauge there, for the whole way
};

Entry enter(real3 from, real3 to) {
    real3 along = to - from;
    real doubt = doubtFor(from, to);
    real nearest = clamp(-dot(from, along) / max(dot(along, along), real(1e-30)), real(0), real(1));
    real3 closest = from + nearest * along;
    real far = sqrt(dot(closest, closest));
    Entry r = Entry(false, true, nearest, real(-1));
    bool surelyIn = far < real(radii.x) * (real(1) - doubt);
    r.enters = surelyIn;
    if (!surelyIn && !(far > real(radii.y) * (real(1) + doubt))) {
        real low = real(0), high = real(1), lowSlope, highSlope, slope;
        real lowGauge = gaugeAt(from, along, lowSlope), highGauge = gaugeAt(to, along, highSlope);
        bool decided = false;
        real least = min(lowGauge, highGauge);
        for (int k = 0; k < 24 && !decided; ++k) {
            if (highSlope <= real(0) || lowSlope >= real(0)) {
                bool falling = highSlope <= real(0);
                real end = falling ? highGauge : lowGauge;
                r.at = falling ? high : low;
                r.enters = falling && end < real(1);
                r.sure = abs(end - real(1)) >= doubt;
                decided = true;
                break;
            }
            real t = clamp((lowGauge - highGauge + highSlope * high - lowSlope * low) / (highSlope - lowSlope), low,
                           high);
            r.at = t;
            // The tangents' meeting is rounded as the gauges of both ends are.
            real below = lowGauge + lowSlope * (t - low);
            if (below >= real(1) + doubt * (lowGauge + highGauge)) {
                decided = true;
                break;
            }
            if (!(high - low > narrow)) break;
            real gauge = gaugeAt(from + t * along, along, slope);
            least = min(least, gauge);
            if (gauge < real(1) - doubt) {
                r.enters = true;
                decided = true;
                break;
            }
            if (slope < real(0)) {
                low = t;
                lowGauge = gauge;
                lowSlope = slope;
            } else {
                high = t;
                highGauge = gauge;
                highSlope = slope;
            }
        }
        if (!decided) r.sure = least > real(1) + doubt || doubt == real(0);
    }
    if (r.enters) {
        real outside = real(0), inside = r.at, t = real(0), slope;
        for (int k = 0; k < 60; ++k) {
            real gauge = gaugeAt(from + t * along, along, slope);
            bool isOut = gauge >= real(1);
            if (isOut) outside = t;
            else inside = t;
            r.at = t;
            r.slope = slope;
            if (!(abs(gauge - real(1)) > max(onSurface, doubt) && inside - outside > narrowEntry)) break;
            real next = t + (real(1) - gauge) / slope;
            t = next > outside && next < inside ? next : real(0.5) * (outside + inside);
        }
    }
    return r;
}

/// Where the plane mirrors the vertex; false where not both are in front of it.
bool planeMirror(real3 foot, real3 normal, real3 eye, real3 vertex, out real3 mirror) {
    real a = dot(eye - foot, normal), b = dot(vertex - foot, normal);
    real3 eyeFoot = eye - a * normal, vertexFoot = vertex - b * normal;
    mirror = vertexFoot + (b / (a + b)) * (eyeFoot - vertexFoot);
    return a > real(0) && b >= real(0);
}

/// SearchStart-inl.h's closeGauge and poorStart.
const real closeGauge = real(1.5);
const real poorStart = real(0.5);

/// Of the bisector seen from the centre.
real3 startFromTable(real3 vertex, uint table) {
    return startOfNormal(real3(eyeUnit.xyz) + vertex / max(sqrt(dot(vertex, vertex)), real(1e-30)), table);
}

/// Direction from the centre to start from, stretch taken out.
real3 startFor(real3 eye, real3 vertex) {
    real3 by = stretchBy();
    real3 start = startFromTable(vertex, 0u);
    real3 mirror;
    real eyeGauge = real(eyeInMap.w);
    if (eyeGauge < closeGauge && planeMirror(real3(eyeFoot.xyz), real3(eyeNormal.xyz), eye, vertex, mirror))
        start = mirror / by;
    real3 inCube = vertex / by;
    if (dot(inCube, inCube) < squared(closeGauge * real(radii.y))) {
        OnCube under = onCube(inCube);
        Surface surface = surfaceAt(under);
        real3 foot = by * outOfFace(under, real3(under.s, under.t, 1) / surface.q);
        real3 upright = outOfFace(under, surface.m) / by;
        bool works = planeMirror(foot, upright / sqrt(dot(upright, upright)), eye, vertex, mirror);
        if (works && under.largest * surface.q < min(closeGauge, eyeGauge)) start = mirror / by;
    }
    return start;
}

real3 normalAt(real3 direction) {
    OnCube at = onCube(direction);
    real3 m = outOfFace(at, surfaceAt(at).m) / stretchBy();
    return m / sqrt(dot(m, m));
}
