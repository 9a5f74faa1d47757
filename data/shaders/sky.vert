#version 450 core
// One triangle over the whole view at infinite depth.
#ifdef LAYERED
#extension GL_ARB_shader_viewport_layer_array : enable
#endif
#include "frame.glsl"
uniform mat4 relativeFromClip;
layout(location = 0) out vec3 directionOut;
void main() {
    vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
    gl_Position = vec4(corner, 0.0, 1.0);
    vec4 near = relativeFromClip * vec4(corner, 1.0, 1.0);
    directionOut = near.xyz / near.w;
#ifdef LAYERED
    gl_Layer = int(frame.eyeLow.w);
#endif
}
