#version 450 core
#include "reference_lookup.glsl"
#include "local_map_job.glsl"
#include "local_map_levels.glsl"

// Local maps of one face size: all faces of all maps in one dispatch, a group of 8 x 8 texels each; z is the face.
// Writes levels 0 to 3; the mean of each group goes on to local_map_coarse.comp.

layout(std430, binding = 3) readonly restrict buffer Reciprocals { float reciprocals[]; };
/// Moving objects: colour, and depth in the last, beyond all where there is none.
layout(std430, binding = 4) readonly restrict buffer Overlays { vec4 overlays[]; };

/// PackedMips::nearness, where it is wanted.
layout(r16f, binding = 4) writeonly restrict uniform imageCubeArray nearness;
uniform bool keepNearness;

/// CubeMapping.h's cubeFaces.
vec3 cubeDirection(int face, vec2 texel) {
    vec2 st = texel * (2.0 / float(faceSize)) - 1.0;
    switch (face) {
        case 0: return vec3(1.0, -st.y, -st.x);
        case 1: return vec3(-1.0, -st.y, st.x);
        case 2: return vec3(st.x, 1.0, st.y);
        case 3: return vec3(st.x, -1.0, -st.y);
        case 4: return vec3(st.x, -st.y, 1.0);
        default: return vec3(-st.x, -st.y, -1.0);
    }
}

/// Where the ray of a texel starts: 1 / reciprocal, the sky a cube skyDepth away.
float startOf(uint first, ivec2 texel) {
    return min(1.0 / max(reciprocals[first + uint(texel.y * faceSize + texel.x)], 1.0 / skyDepth), skyDepth);
}

/// Radiance of the sky alone (LookupOptions::sky).
layout(std430, binding = 6) readonly restrict buffer Skies { vec4 skies[]; };

float reciprocalOf(uint first, int x, int y) { return reciprocals[first + uint(y * faceSize + x)]; }

/// DetailOrder.cpp's patchAround.
SurfacePatch patchAround(uint first, int face, ivec2 at) {
    vec2 st = (vec2(at) + 0.5) * (2.0 / float(faceSize)) - 1.0;
    ivec2 before = max(at - 1, 0), after = min(at + 1, faceSize - 1);
    vec2 apart = vec2(max(after - before, 1)) * (2.0 / float(faceSize));
    vec2 slope = vec2(reciprocalOf(first, after.x, at.y) - reciprocalOf(first, before.x, at.y),
                      reciprocalOf(first, at.x, after.y) - reciprocalOf(first, at.x, before.y)) / apart;
    float own = reciprocalOf(first, at.x, at.y);
    // A face's directions are linear in its coordinates: major + s sAxis + t tAxis.
    vec2 middle = vec2(0.5 * float(faceSize));
    vec3 major = cubeDirection(face, middle);
    vec3 sAxis = cubeDirection(face, middle + vec2(middle.x, 0.0)) - major;
    vec3 tAxis = cubeDirection(face, middle + vec2(0.0, middle.y)) - major;
    return SurfacePatch((major + st.x * sAxis + st.y * tAxis) / max(own, 1.0 / skyDepth),
                        (own - dot(st, slope)) * major + slope.x * sAxis + slope.y * tAxis);
}

void main() {
    FaceJob job = faceJobs[uint(firstJob) + gl_WorkGroupID.z];
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    // Sixteen neighbours in a row share an order.
    ivec2 middle = ivec2(min((texel.x & ~15) + 8, faceSize - 1), texel.y);
    float depth = infinity;
    vec3 colour;
    if (job.sky != 0xffffffffu && reciprocalOf(job.start, texel.x, texel.y) <= 1.0 / skyDepth)
        colour = skies[job.sky + uint(texel.y * faceSize + texel.x)].rgb;
    else
        colour = lookUpRefined(cubeDirection(job.face, vec2(texel) + 0.5), startOf(job.start, texel),
                                patchAround(job.start, job.face, middle),
                                job.firstView, job.viewCount, job.lookups, job.agreement, depth);
    if (all(greaterThanEqual(texel, job.overlayBox.xy)) && all(lessThan(texel, job.overlayBox.zw))) {
        ivec2 at = texel - job.overlayBox.xy;
        vec4 object = overlays[job.overlay + uint(at.y * (job.overlayBox.z - job.overlayBox.x) + at.x)];
        if (object.w < depth) {
            colour = object.rgb;
            depth = object.w;
        }
    }
    imageStore(level0, ivec3(texel, job.layer), uvec4(packTexel(colour)));
    if (keepNearness) imageStore(nearness, ivec3(texel, job.layer), vec4(depth < infinity ? 1.0 / depth : 0.0));
    vec3 mean = storeHalves(colour, ivec2(8 * gl_WorkGroupID.xy), 8, job.layer);
    if (gl_LocalInvocationIndex == 0u) {
        uint groups = gl_NumWorkGroups.x;
        means[uint(firstMean) + (gl_WorkGroupID.z * groups + gl_WorkGroupID.y) * groups + gl_WorkGroupID.x] = vec4(mean, 0.0);
    }
}
