#version 450 core
#include "reference_lookup.glsl"
#include "local_map_job.glsl"
#include "local_map_levels.glsl"

// Local maps of one face size: all faces of all maps in one dispatch, a group of 8 x 8 texels each; z is the face.
// Writes levels 0 to 3; the mean of each group goes on to local_map_coarse.comp.

layout(std430, binding = 3) readonly restrict buffer Reciprocals { float reciprocals[]; };
/// Moving objects: colour, and depth in the last, beyond all where there is none.
layout(std430, binding = 4) readonly restrict buffer Overlays { vec4 overlays[]; };

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

void main() {
    FaceJob job = faceJobs[uint(firstJob) + gl_WorkGroupID.z];
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    // Eight neighbours in a row share an order, as in a vector of the processor's.
    ivec2 middle = ivec2((texel.x & ~7) + 4, texel.y);
    float depth;
    vec3 colour = lookUpRefined(cubeDirection(job.face, vec2(texel) + 0.5), startOf(job.start, texel),
                                startOf(job.start, middle) * cubeDirection(job.face, vec2(middle) + 0.5),
                                job.firstView, job.viewCount, job.lookups, job.agreement, depth);
    if (all(greaterThanEqual(texel, job.overlayBox.xy)) && all(lessThan(texel, job.overlayBox.zw))) {
        ivec2 at = texel - job.overlayBox.xy;
        vec4 object = overlays[job.overlay + uint(at.y * (job.overlayBox.z - job.overlayBox.x) + at.x)];
        if (object.w < depth) colour = object.rgb;
    }
    imageStore(level0, ivec3(texel, job.layer), uvec4(packTexel(colour)));
    vec3 mean = storeHalves(colour, ivec2(8 * gl_WorkGroupID.xy), 8, job.layer);
    if (gl_LocalInvocationIndex == 0u) {
        uint groups = gl_NumWorkGroups.x;
        means[uint(firstMean) + (gl_WorkGroupID.z * groups + gl_WorkGroupID.y) * groups + gl_WorkGroupID.x] = vec4(mean, 0.0);
    }
}
