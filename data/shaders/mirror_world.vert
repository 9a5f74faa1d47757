#version 450 core
#ifdef LAYERED
#extension GL_ARB_shader_viewport_layer_array : require
#endif
// Lit things, mirrors and curved reflectors of a small scene (app/render/MirrorWorldRenderer).
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 colour;
uniform vec3 eye;
uniform mat4 clipFromRelative;
uniform vec4 glass;  // inside: dot(xyz, relative) + w >= 0
#ifdef PARABOLOID
uniform mat3 viewFromRelative;
uniform float nearPlane;
#endif
#ifdef LAYERED
uniform int layer;
#endif
invariant gl_Position;
out float gl_ClipDistance[2];
layout(location = 0) out vec3 relativeOut;
layout(location = 1) out vec3 normalOut;
layout(location = 2) out vec3 colourOut;

void main() {
    vec3 relative = position - eye;
    gl_ClipDistance[0] = dot(glass.xyz, relative) + glass.w;
#ifdef PARABOLOID
    vec3 v = viewFromRelative * relative;
    float way = max(length(v), 1e-6);
    v /= way;
    gl_ClipDistance[1] = 0.3 - v.z;  // a little behind the eye, for triangles that reach round
    gl_Position = vec4(v.xy / (1.0 - min(v.z, 0.9)), nearPlane / way, 1.0);
#else
    gl_ClipDistance[1] = 1.0;
    gl_Position = clipFromRelative * vec4(relative, 1.0);
#endif
#ifdef LAYERED
    gl_Layer = layer;
#endif
    relativeOut = relative;
    normalOut = normal;
    colourOut = colour;
}
