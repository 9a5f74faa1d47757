#version 450 core
#include "local_map_job.glsl"
#include "local_map_levels.glsl"

// The levels that local_map.comp leaves: from the means of its groups, the texels of level 3, down to one texel. A
// group a face; face sizes up to 128, whose level 4 has 8 x 8 texels.

void main() {
    int layer = faceJobs[uint(firstJob) + gl_WorkGroupID.z].layer;
    ivec2 id = ivec2(gl_LocalInvocationID.xy);
    int finer = faceSize >> 3, side = faceSize >> 4;
    vec3 colour = vec3(0.0);
    if (id.x < side && id.y < side) {
        int from = firstMean + (int(gl_WorkGroupID.z) * finer + 2 * id.y) * finer + 2 * id.x;
        colour = 0.25 * ((means[from].rgb + means[from + 1].rgb) + (means[from + finer].rgb + means[from + finer + 1].rgb));
        imageStore(level0, ivec3(id, layer), uvec4(packTexel(colour)));
    }
    storeHalves(colour, ivec2(0), side, layer);
}
