#version 450 core
// The static city: all light that does not need a texture is worked out per vertex.
#ifdef LAYERED
#extension GL_ARB_shader_viewport_layer_array : enable
#endif
#include "frame.glsl"
#include "shadow.glsl"

struct MaterialEntry {
    vec4 tint;      // rgb albedo; w: layer of the pattern array
    vec4 emission;  // rgb
};
layout(std140, binding = 1) uniform Materials { MaterialEntry materials[1024]; };

#ifdef VIRTUAL
// Seen in a piece of chrome: where it is seen there, and what it is where it truly stands.
layout(location = 0) in vec3 fromEye;  // in the reflector's frame, as far away as the light's whole path is long
layout(location = 1) in vec3 position;
layout(location = 2) in vec2 texcoord;
layout(location = 3) in vec3 normal;
layout(location = 4) in float materialIndex;
uniform mat4 clipFromVirtual;
uniform mat4 relativeFromMesh;
const float open = 1.0;
#else
layout(location = 0) in vec3 position;
layout(location = 1) in vec2 texcoord;
layout(location = 2) in vec4 normal;
layout(location = 3) in uint material;
layout(location = 4) in float open;
#endif
#ifdef INSTANCED
layout(location = 5) in vec4 worldFromPrototype0;  // rows
layout(location = 6) in vec4 worldFromPrototype1;
layout(location = 7) in vec4 worldFromPrototype2;
#endif
#if defined CUBE || defined WET || defined VIRTUAL
layout(location = 5) out vec3 relativeOut;
#endif
#ifdef WET
layout(location = 6) out vec3 normalOut;
#endif

layout(location = 0) out vec2 texcoordOut;
layout(location = 1) flat out float layerOut;
#ifndef DEPTH
layout(location = 2) out vec3 shadedOut;   // tint times everything but the sun
layout(location = 3) out vec3 sunlitOut;   // tint times the sun
layout(location = 4) out vec3 shadowOut;
#endif

void main() {
#if defined VIRTUAL
    vec3 relative = (relativeFromMesh * vec4(position, 1.0)).xyz;
    vec3 world = relative + frame.eyeHigh.xyz + frame.eyeLow.xyz;
    vec3 n = normalize(normal);
    uint material = uint(materialIndex + 0.5);
    gl_Position = clipFromVirtual * vec4(fromEye, 1.0);
    relativeOut = relative;
#else
#ifdef INSTANCED
    vec4 local = vec4(position, 1.0);
    vec3 world = vec3(dot(worldFromPrototype0, local), dot(worldFromPrototype1, local), dot(worldFromPrototype2, local));
    vec3 n = normalize(vec3(dot(worldFromPrototype0.xyz, normal.xyz), dot(worldFromPrototype1.xyz, normal.xyz),
                            dot(worldFromPrototype2.xyz, normal.xyz)));
#else
    vec3 world = position;
    vec3 n = normal.xyz;
#endif
    vec3 relative = relativeFromWorld(world);
    gl_Position = frame.clipFromRelative * vec4(relative, 1.0);
#if defined CUBE || defined WET
    relativeOut = relative;
#endif
#ifdef WET
    normalOut = n;
#endif
#ifdef LAYERED
    gl_Layer = int(frame.eyeLow.w);
#endif
#endif
    MaterialEntry m = materials[material];
    texcoordOut = texcoord;
    layerOut = m.tint.w;
#ifndef DEPTH
    vec3 albedo = m.tint.rgb * inversePi;
    shadedOut = albedo * ambientIrradiance(n, open) + m.emission.rgb * frame.skyIrradiance.w;
    sunlitOut = albedo * frame.sunIrradiance.rgb * max(dot(n, frame.sunDirection.xyz), 0.0);
    shadowOut = shadowCoordinate(world, n);
#endif
}
