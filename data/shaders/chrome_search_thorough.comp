#version 450 core
#define REAL_IS_DOUBLE
#include "chrome_map.glsl"
#include "chrome_result.glsl"

// An answer for every vertex at any price (ThoroughSearch.cpp's searchThoroughly), a group a vertex: the error at the
// nodes of a lattice, descents from the least ones and from cells around which the bisector turns, the shortest of what
// they find. Concave pieces, and what chrome_search.comp leaves.

layout(local_size_x = 32) in;

/// Concave pieces: every vertex; else those left.
uniform bool everyVertex;

/// A face's lattice has at most 32 cells a side.
const uint mostNodes = 33u * 33u;
/// ThoroughSearch.cpp's lattice: a bowl has some ten; what is beyond this is left out.
const uint mostStarts = 128u;
const uint latticeSide = 16u, concaveSide = 32u;
const real enough = 1e-14lf, still = 1e-16lf;
const int mostLookups = 160;

shared float cosines[mostNodes];
shared vec2 acrosses[mostNodes];
shared vec3 starts[mostStarts];
shared uint startCount;
shared double shortest[2][gl_WorkGroupSize.x];  // on the part, on its closing surface
shared uint winner, winnerKind;

vec3 cornerPoint(uint face, vec2 st) {
    switch (face) {
        case 0u: return vec3(1.0, -st.y, -st.x);
        case 1u: return vec3(-1.0, -st.y, st.x);
        case 2u: return vec3(st.x, 1.0, st.y);
        case 3u: return vec3(st.x, -1.0, -st.y);
        case 4u: return vec3(st.x, -st.y, 1.0);
        default: return vec3(-st.x, -st.y, -1.0);
    }
}

/// Float: a node only says where to start.
void judgeNode(uint face, uint column, uint row, vec3 eye, vec3 vertex, uint slot) {
    vec3 by = vec3(stretchInMap.xyz);
    vec3 g = cornerPoint(face, vec2(column, row) * (2.0 / float(cells)) - 1.0);
    vec4 c = corners[cornerIndex(face, column, row)];
    vec3 p = by * g / (c.w * dot(c.xyz, g));
    vec3 n = normalize(c.xyz / by);
    vec3 o = eye - p, v = vertex - p;
    vec3 h = o / max(length(o), 1e-30) + v / max(length(v), 1e-30);
    vec3 across = (h - dot(h, n) * n) / by;
    vec3 major = cornerPoint(face, vec2(0.0));
    cosines[slot] = dot(h, n) / max(length(h), 1e-30);
    acrosses[slot] = vec2(dot(across, cornerPoint(face, vec2(1.0, 0.0)) - major),
                          dot(across, cornerPoint(face, vec2(0.0, 1.0)) - major));
}

float turnBetween(vec2 a, vec2 b) { return atan(a.x * b.y - a.y * b.x, dot(a, b)); }

void addStart(vec3 direction) {
    uint place = atomicAdd(startCount, 1u);
    if (place < mostStarts) starts[place] = direction;
}

/// The starts of one face from its nodes, an invocation a node.
void findStarts(uint face, uint step, uint side) {
    for (uint slot = gl_LocalInvocationID.x; slot < side * side; slot += gl_WorkGroupSize.x) {
        uint column = slot % side, row = slot / side;
        float own = cosines[slot];
        if (!(own > 0.0)) continue;
        bool best = true;
        for (int dy = -1; dy <= 1 && best; ++dy)
            for (int dx = -1; dx <= 1 && best; ++dx) {
                int x = int(column) + dx, y = int(row) + dy;
                if (x >= 0 && y >= 0 && x < int(side) && y < int(side))
                    best = cosines[uint(y) * side + uint(x)] <= own;
            }
        if (best) addStart(cornerPoint(face, vec2(column, row) * (2.0 * float(step) / float(cells)) - 1.0));
        if (column + 1u >= side || row + 1u >= side) continue;
        uint b = slot + 1u, c = slot + side + 1u, d = slot + side;
        if (!(cosines[b] > 0.0 && cosines[c] > 0.0 && cosines[d] > 0.0)) continue;
        float turn = turnBetween(acrosses[slot], acrosses[b]) + turnBetween(acrosses[b], acrosses[c]) +
                     turnBetween(acrosses[c], acrosses[d]) + turnBetween(acrosses[d], acrosses[slot]);
        if (abs(turn) > 3.0)
            addStart(cornerPoint(face, (vec2(column, row) + 0.5) * (2.0 * float(step) / float(cells)) - 1.0));
    }
}

/// Where nothing is found: hidden where the line of sight says so, else the closing surface's point, else a guess.
void writeUnfound(uint index, real3 eye, real3 vertex) {
    real3 by = stretchBy();
    bool convex = concave == 0u;
    real3 from = convex ? eye : vertex, to = convex ? vertex : eye;
    real slope;
    bool outside = gaugeAt(from / by, real3(1, 0, 0), slope) > real(1);
    uint status = statusUnreflected;
    real3 point = startFromTable(vertex, 0u);
    if (outside) {
        Entry entry = enter(from / by, to / by);
        real3 met = (from + entry.at * (to - from)) / by;
        if (entry.enters && (convex || coverageAt(met) >= real(0.5))) {
            status = statusHidden;
            point = met;
        }
    }
    if (status == statusUnreflected && winnerKind == 1u) return;  // the winner writes its own
    OnCube at = onCube(point);
    real3 p = by * outOfFace(at, real3(at.s, at.t, 1) / surfaceAt(at).q);
    real3 toEye = eye - p, toVertex = vertex - p;
    writeResult(index, status, eye, vertex, p, normalAt(point), real(0),
                sqrt(dot(toEye, toEye)) + sqrt(dot(toVertex, toVertex)));
    winnerKind = 2u;
}

void main() {
    uint me = gl_LocalInvocationID.x;
    uint todo = everyVertex ? vertexCount : left[1].count;
    // As fine as the patches that the processor descends from (SurfacePatches.cpp).
    uint step = concave != 0u ? (cells + concaveSide - 1u) / concaveSide : max(1u, cells / latticeSide);
    uint side = cells / step + 1u;
    for (uint i = gl_WorkGroupID.x; i < todo; i += gl_NumWorkGroups.x) {
        uint index = everyVertex ? i : leftVertex[vertexCount + i];
        vec3 given;
        // The same for the whole group.
        if (!vertexOf(index, given)) {
            if (me == 0u) writeInvalid(index);
            continue;
        }
        real3 vertex = intoMap(given), eye = real3(eyeInMap.xyz);
        if (me == 0u) startCount = 0u;
        for (uint face = 0u; face < 6u; ++face) {
            barrier();
            for (uint slot = me; slot < side * side; slot += gl_WorkGroupSize.x)
                judgeNode(face, slot % side * step, slot / side * step, vec3(eye), vec3(vertex), slot);
            barrier();
            findStarts(face, step, side);
        }
        barrier();
        // The best of this invocation's descents, of both kinds.
        const real none = real(1e30);
        real3 point[2], normal[2];
        real error[2];
        shortest[0][me] = none;
        shortest[1][me] = none;
        for (uint k = me; k < min(startCount, mostStarts); k += gl_WorkGroupSize.x) {
            Judged end = descend(eye, vertex, judge(eye, vertex, real3(starts[k]), false), false, enough, still,
                                 mostLookups);
            if (!(end.error <= enough)) continue;
            uint kind = coverageAt(end.point / stretchBy()) >= real(0.5) ? 0u : 1u;
            if (!(end.path < shortest[kind][me])) continue;
            shortest[kind][me] = end.path;
            point[kind] = end.point;
            normal[kind] = end.normal;
            error[kind] = end.error;
        }
        barrier();
        if (me == 0u) {
            winnerKind = 2u;
            for (uint kind = 0u; kind < 2u && winnerKind == 2u; ++kind) {
                real least = none;
                for (uint k = 0u; k < gl_WorkGroupSize.x; ++k)
                    if (shortest[kind][k] < least) {
                        least = shortest[kind][k];
                        winner = k;
                        winnerKind = kind;
                    }
            }
            if (winnerKind != 0u) writeUnfound(index, eye, vertex);
        }
        barrier();
        if (winnerKind != 2u && winner == me) {
            uint kind = winnerKind;
            writeResult(index, kind == 0u ? statusFound : statusUnreflected, eye, vertex, point[kind], normal[kind],
                        angleOf(error[kind]), shortest[kind][me]);
        }
    }
}
