#version 450 core
// A lit disc: the lamp of a signal head.
#ifdef LAYERED
#extension GL_ARB_shader_viewport_layer_array : enable
#endif
#include "frame.glsl"
layout(location = 0) in vec4 place;   // xyz: centre, relative to the eye; w: radius
layout(location = 1) in vec4 facing;  // unit
layout(location = 2) in vec4 colour;
layout(location = 0) out vec2 positionOut;
layout(location = 1) flat out vec3 colourOut;
#ifdef CUBE
layout(location = 2) out vec3 relativeOut;
#endif
void main() {
    vec2 p = vec2((gl_VertexID & 1) != 0 ? 1.0 : -1.0, (gl_VertexID & 2) != 0 ? 1.0 : -1.0);
    vec3 side = normalize(cross(vec3(0.0, 0.0, 1.0), facing.xyz + vec3(1e-5, 0.0, 0.0)));
    vec3 relative = place.xyz + place.w * (p.x * side + p.y * cross(facing.xyz, side));
    positionOut = p;
    colourOut = colour.rgb;
    gl_Position = frame.clipFromRelative * vec4(relative, 1.0);
#ifdef CUBE
    relativeOut = relative;
#endif
#ifdef LAYERED
    gl_Layer = int(frame.eyeLow.w);
#endif
}
