// The refined lookup of local maps' texels in packed reference maps: reflection/local_map/ReferenceLookup.cpp for
// one texel an invocation. Names, steps and constants are that file's, so that a change there is easily made
// here; what differs is said where it differs.

const uint nearnessMask = 0x7ffu;  // PackedReferenceMap.h from here to skyDepth
const uint nearnessBits = 11u;
const uint nearnessExponentBias = 127u - 13u;
const uint sumMantissaShift = 18u;
const uint sumExponentBias = 127u - 16u;
const float skyDepth = 8192.0;
const float infinity = 3.0e38;  // finite: GLSL promises nothing for the real one

layout(binding = 0) uniform usamplerBuffer packedMaps;

/// One level of a reference map, as seen from a local map's centre (C++: LocalMapPass::MapView).
struct MapView {
    uint words;   // where its 20-bit words begin, in uints
    uint chroma;  // where its chroma begins, in uints
    int faceSize;
    int chromaColumns;
    vec3 offset;
    float radianceScale;
};

layout(std430, binding = 1) readonly restrict buffer MapViews { MapView mapViews[]; };

struct FacePoint {
    int face;
    vec2 uv;      // texels from the face's corner, 0 .. faceSize
    float depth;  // along the face's major axis
};

FacePoint toFace(vec3 p, int faceSize) {
    vec3 a = abs(p);
    bool isX = a.x >= a.y && a.x >= a.z;
    bool isY = !isX && a.y >= a.z;
    // A map's own centre has no direction; any does.
    float major = max(max(a.x, max(a.y, a.z)), 1e-30);
    float value = isX ? p.x : isY ? p.y : p.z;
    bool negative = value < 0.0;
    float flip = negative ? -1.0 : 1.0;
    float s = isX ? -p.z * flip : isY ? p.x : p.x * flip;
    float t = isY ? p.z * flip : -p.y;
    float size = 0.5 * float(faceSize);
    return FacePoint((isX ? 0 : isY ? 2 : 4) + int(negative), vec2(s, t) * (size / major) + size, major);
}

/// The 20-bit words of a bordered texel and of the one behind it: bit 20 * index on, little-endian.
uvec2 fetchPair(MapView map, uint index) {
    uint bit = 20u * index;
    uint at = map.words + (bit >> 5);
    uint shift = bit & 31u;
    uint low = texelFetch(packedMaps, int(at)).r, high = texelFetch(packedMaps, int(at) + 1).r;
    // A shift by 32 is undefined: (x << 1) << (31 - shift).
    uint first = (low >> shift) | ((high << 1) << (31u - shift));
    shift += 20u;
    if (shift >= 32u) {
        shift -= 32u;
        low = high;
        high = shift > 12u ? texelFetch(packedMaps, int(at) + 2).r : 0u;
    }
    uint second = (low >> shift) | ((high << 1) << (31u - shift));
    return uvec2(first, second) & 0xfffffu;
}

vec2 nearnessOf(uvec2 word) {
    return uintBitsToFloat(((word & nearnessMask) << 16) + (nearnessExponentBias << 23));
}
vec2 sumOf(uvec2 word) {
    return uintBitsToFloat(((word >> nearnessBits) << sumMantissaShift) + (sumExponentBias << 23));
}

/// What a map holds in the direction of a point.
struct Probe {
    float disagreement;  // depth of the point times the nearness there, minus 1
    float sum;           // R+G+B
    int chromaBlock;
};

const float tornShare = 0.3;

/// Brightness is bilinear. So is nearness on a surface; across an edge it is the nearest texel's. The block of
/// the nearest texel for chroma.
Probe probe(MapView map, vec3 point) {
    FacePoint p = toFace(point, map.faceSize);
    vec2 uv = clamp(p.uv + 0.5, vec2(0.0), vec2(float(map.faceSize) + 0.9999));
    ivec2 at = ivec2(uv);
    vec2 f = uv - vec2(at);
    int m = map.faceSize + 2;
    int index = (p.face * m + at.y) * m + at.x;
    uvec2 upper = fetchPair(map, uint(index)), lower = fetchPair(map, uint(index + m));
    vec2 above = nearnessOf(upper), below = nearnessOf(lower);
    vec2 most = max(above, below), least = min(above, below);
    bool torn = min(least.x, least.y) < max(most.x, most.y) * (1.0 - tornShare);
    vec2 row = f.y >= 0.5 ? below : above;
    vec2 mixed = mix(above, below, f.y);
    float nearness = torn ? (f.x >= 0.5 ? row.y : row.x) : mix(mixed.x, mixed.y, f.x);
    vec2 sum = mix(sumOf(upper), sumOf(lower), f.y);
    int rows = m / 2;
    ivec2 block = min(ivec2(uv + 0.5) >> ivec2(2, 1), ivec2(map.chromaColumns, rows) - 1);
    return Probe(p.depth * nearness - 1.0, mix(sum.x, sum.y, f.x),
                 (p.face * rows + block.y) * map.chromaColumns + block.x);
}

vec3 colourOf(MapView map, float sum, int chromaBlock) {
    uint shares = texelFetch(packedMaps, int(map.chroma) + (chromaBlock >> 1)).r >> (16 * (chromaBlock & 1));
    float red = float(shares & 0xffu) / 255.0;
    float blue = float((shares >> 8) & 0xffu) / 255.0;
    return sum * map.radianceScale * vec3(red, max(0.0, 1.0 - red - blue), blue);
}

/// A point and the plane {x : plane . x = 1} around it, seen from the local map's centre.
struct SurfacePatch {
    vec3 point;
    vec3 plane;
};

/// How unlike the local map's own detail a map sees a patch: DetailOrder.cpp's orderByDetail.
float misfitOf(MapView map, SurfacePatch around) {
    const float grazing = 0.01;
    vec3 apart = around.point - map.offset;
    float squared = max(dot(around.point, around.point), 1e-30) / max(dot(apart, apart), 1e-30);
    float along = (1.0 - dot(around.plane, map.offset)) * squared;
    float across = sqrt(squared);
    return along > grazing ? max(max(along, across), 1.0 / min(along, across))
                           : (1.0 / grazing) * (1.0 + 1.0 / squared);
}

/// The candidate that follows the one of this misfit and number in the order by misfit, then number. Found anew
/// each time instead of sorted once: most texels ask one candidate, and a sorted list would have to live in memory.
uint nextByDetail(uint firstView, uint count, SurfacePatch seen, inout float misfit, uint last) {
    uint best = count;
    float bestMisfit = infinity;
    for (uint k = 0u; k < count; ++k) {
        float m = misfitOf(mapViews[firstView + k], seen);
        bool follows = m > misfit || (m == misfit && (last == count || k > last));
        if (follows && (m < bestMisfit || best == count)) {
            best = k;
            bestMisfit = m;
        }
    }
    misfit = bestMisfit;
    return best;
}

/// The colour of one texel. `direction`: of the texel's ray; `start`: its heightfield hit, 1 / reciprocal;
/// `seen`: around the middle one of the texels that share an order. Without candidates black sky.
vec3 lookUpRefined(vec3 direction, float start, SurfacePatch seen, uint firstView, uint count, int lookups,
                   float agreement, out float depth) {
    float dd = dot(direction, direction);
    float bestError = infinity, bestDepth = count > 0u ? start : infinity;
    vec3 colour = vec3(0.0);
    float misfit = -1.0;
    uint k = count;
    for (uint asked = 0u; asked < count; ++asked) {
        k = nextByDetail(firstView, count, seen, misfit, k);
        if (k >= count) break;
        MapView map = mapViews[firstView + k];
        float dc = dot(direction, map.offset);
        float ta = start;
        Probe at = probe(map, ta * direction - map.offset);
        float qa = at.disagreement, sum = at.sum, error = abs(qa), candidateDepth = ta;
        int block = at.chromaBlock;
        float tb = ta, qb = qa;
        for (int step = 1; step < lookups && error > agreement; ++step) {
            float next;
            if (step == 1) {
                // The candidate's surface point C + (X - C) / (1 + q), projected onto the ray.
                next = ((ta * dd - dc) / max(qa + 1.0, 1e-4) + dc) / dd;
                next = min(next, skyDepth);
                next = next > 0.0 ? next : 0.25 * tb;
            } else {
                float slope = qb - qa;
                next = abs(slope) < 1e-6 ? tb : tb - qb * (tb - ta) / slope;
                next = max(min(next, skyDepth), 0.25 * tb);
            }
            ta = tb;
            qa = qb;
            tb = next;
            at = probe(map, tb * direction - map.offset);
            qb = at.disagreement;
            if (abs(qb) < error) {
                error = abs(qb);
                candidateDepth = tb;
                sum = at.sum;
                block = at.chromaBlock;
            }
        }
        if (error < bestError) {
            colour = colourOf(map, sum, block);
            bestError = error;
            bestDepth = candidateDepth;
        }
        if (bestError <= agreement) break;
    }
    // Between the farthest building and the sky there is nothing: halfway decides.
    depth = bestDepth >= 0.5 * skyDepth ? infinity : bestDepth;
    return colour;
}
