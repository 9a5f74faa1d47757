#version 450 core
#include "chrome_map.glsl"
#include "chrome_result.glsl"

// Reflection points on a convex piece, an invocation a vertex (ReflectionSearch.cpp's searchPackets;
// QuickSearch-inl.h's descents before it give the same answers without the test for hidden vertices, which packets gain
// from and invocations do not). Compiled twice: in
// float for all vertices; in double (REAL_IS_DOUBLE) for those that float does not settle. What neither settles is left
// to chrome_search_thorough.comp.

layout(local_size_x = 64) in;

#ifdef REAL_IS_DOUBLE
const uint nextList = 1u, perGroup = 1u;
const real enough = 1e-14lf, still = 1e-16lf;
/// ReflectionSearch.cpp's rimTolerance, squared: where the part has a rim.
const real enoughAtRims = 1e-24lf;
const int mostLookups = 40;
#else
const uint nextList = 0u, perGroup = 64u;
const int mostLookups = 20;
/// Steps that no longer move the point by a float.
const real still = 6e-8;
/// Radians, seen from the eye, by which float may be wrong: a third of the 1e-4 that are asked. Measured errors end a
/// tenth of it below.
const real mostUncertain = 3e-5;
/// Rounding of h at distances of one radius: positions and both unit vectors, two roundings each and their sum, with
/// that again for the map's blending.
const real roundingOfH = 8 * 6e-8;
/// Radii, for which float will do.
const real farthest = 1e9;
/// Of a blended coverage: cells times the rounding of (s, t).
const real coverageDoubt = 1e-3;
#endif

void leave(uint index) {
    uint place = atomicAdd(left[nextList].count, 1u);
    leftVertex[nextList * vertexCount + place] = index;
    // No more than every implementation can dispatch: groups go round.
    atomicMax(left[nextList].groupsX, min(place / perGroup + 1u, 32768u));
}

void search(uint index) {
    vec3 given;
    if (!vertexOf(index, given)) {
        writeInvalid(index);
        return;
    }
    real3 vertex = intoMap(given), eye = real3(eyeInMap.xyz), by = stretchBy();
    real3 way = vertex - eye;
#ifndef REAL_IS_DOUBLE
    // Squares of what is farther overflow.
    if (!(max(max(abs(vertex.x), abs(vertex.y)), abs(vertex.z)) + length(eye) < farthest)) {
        leave(index);
        return;
    }
#endif
    if (eyeInside != 0u) {
        writeResult(index, statusUnreflected, eye, vertex, real3(eyeFoot.xyz), real3(eyeNormal.xyz), real(0),
                    sqrt(dot(way, way)));
        return;
    }
    Entry entry = enter(eye / by, vertex / by);
#ifndef REAL_IS_DOUBLE
    if (!entry.sure) {
        leave(index);
        return;
    }
#endif
    if (entry.enters) {
        real3 met = eye + entry.at * way;
#ifndef REAL_IS_DOUBLE
        // Where the line grazes the surface, rounding moves the entry along the line of sight, and the normal with it.
        real moved = doubtFor(eye / by, vertex / by) * sqrt(dot(way, way)) / max(abs(entry.slope), real(1e-30));
        if (!(moved < real(0.5) * mostUncertain)) {
            leave(index);
            return;
        }
#endif
        real3 toEye = eye - met, toVertex = vertex - met;
        writeResult(index, statusHidden, eye, vertex, met, normalAt(met / by), real(0),
                    sqrt(dot(toEye, toEye)) + sqrt(dot(toVertex, toVertex)));
        return;
    }
    Judged best = judge(eye, vertex, startFor(eye, vertex), true);
    if (best.error > poorStart) {
        Judged deepest = judge(eye, vertex, (eye + entry.at * way) / by, true);
        if (deepest.error < best.error) best = deepest;
    }
#ifdef REAL_IS_DOUBLE
    real until = hasCovered != 0u ? enoughAtRims : enough;
    best = descend(eye, vertex, best, true, until, still, mostLookups);
    bool settled = best.error <= enough;
    if (!settled && hasCovered != 0u) {
        // What has run into the closing surface's creases starts once more, from the part itself.
        Judged again = descend(eye, vertex, judge(eye, vertex, startFromTable(vertex, 1u), true), true, until, still,
                               mostLookups);
        if (again.error <= enough && again.error < best.error) {
            best = again;
            settled = true;
        } else if (coverageAt(best.point / by) < real(0.5) && coverageAt(again.point / by) < real(0.5)) {
            writeResult(index, statusUnreflected, eye, vertex, best.point, best.normal, angleOf(best.error), best.path);
            return;
        }
    }
#else
    // Stops a little above what rounding allows at this distance; what counts is the angle seen from the eye.
    best = descend(eye, vertex, best, true, squared(real(2) * roundingOfH), still, mostLookups);
    // That of the point, and that of the vertex mirrored there: twice the normal's, off / along.
    real off = best.offBy + roundingOfH * (real(1) + best.closeness);
    bool settled = best.error < real(1) && off * (real(2) / best.along + best.uncertain) <= mostUncertain;
#endif
    if (!settled) {
        leave(index);
        return;
    }
    real covered = coverageAt(best.point / by);
#ifndef REAL_IS_DOUBLE
    if (abs(covered - real(0.5)) < coverageDoubt) {
        leave(index);
        return;
    }
#endif
    writeResult(index, covered >= real(0.5) ? statusFound : statusUnreflected, eye, vertex, best.point, best.normal,
                angleOf(best.error), best.path);
}

void main() {
    uint all = gl_NumWorkGroups.x * gl_WorkGroupSize.x;
#ifdef REAL_IS_DOUBLE
    for (uint i = gl_GlobalInvocationID.x; i < left[0].count; i += all) search(leftVertex[i]);
#else
    for (uint i = gl_GlobalInvocationID.x; i < vertexCount; i += all) search(i);
#endif
}
