#version 450 core
#ifdef LAYERED
#extension GL_ARB_shader_viewport_layer_array : require
uniform int layer;
#endif
// One triangle over the whole target, infinitely far.
uniform mat3 relativeFromView;
uniform vec4 projection;  // x, y: ndc for one unit of x / -z; z, w: offsets
#ifdef PARABOLOID
layout(location = 0) out vec2 ndcOut;
#else
layout(location = 0) out vec3 rayOut;  // x, y in view space at depth 1, height in the world
#endif
void main() {
    vec2 ndc = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
    gl_Position = vec4(ndc, 0.0, 1.0);
#ifdef PARABOLOID
    ndcOut = ndc;
#else
    vec3 ray = vec3((ndc + projection.zw) / projection.xy, -1.0);
    rayOut = vec3(ray.xy, (relativeFromView * ray).z);
#endif
#ifdef LAYERED
    gl_Layer = layer;
#endif
}
