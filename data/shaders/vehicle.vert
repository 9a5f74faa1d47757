#version 450 core
#ifdef LAYERED
#extension GL_ARB_shader_viewport_layer_array : enable
#endif
#include "frame.glsl"
#include "shadow.glsl"

// vehicles::Surface: albedo, reflectance at normal incidence (F0).
const vec4 surfaces[12] = vec4[12](vec4(1.0, 1.0, 1.0, 0.04),     // paint: times the instance's colour
                                 vec4(0.012, 0.015, 0.016, 0.06),  // glass
                                 vec4(0.05, 0.05, 0.05, 0.72),     // chrome
                                 vec4(0.018, 0.018, 0.019, 0.012), // tyre
                                 vec4(0.22, 0.22, 0.23, 0.38),     // rim
                                 vec4(0.55, 0.56, 0.58, 0.08),     // head lamp
                                 vec4(0.30, 0.012, 0.010, 0.06),   // tail lamp
                                 vec4(0.016, 0.016, 0.017, 0.02),  // trim
                                 vec4(0.04, 0.038, 0.036, 0.0),    // interior
                                 vec4(0.014, 0.014, 0.015, 0.048), // polished stone
                                 vec4(1.0, 1.0, 1.0, 0.0),         // cloth: times the instance's colour
                                 vec4(0.45, 0.25, 0.17, 0.0));     // skin

layout(binding = 1) uniform sampler2DShadow sunShadow;

#ifdef VIRTUAL
// Seen in a piece of chrome: where it is seen there, and what it is where it truly is.
layout(location = 0) in vec3 fromEye;  // in the reflector's frame, as far away as the light's whole path is long
layout(location = 1) in vec3 position;
layout(location = 2) in vec3 normal;
layout(location = 3) in float surfaceIndex;
uniform mat4 clipFromVirtual;
uniform mat3 worldFromReflector;
uniform mat4 relativeFromMesh;
uniform vec4 paint;
uniform vec4 map;
layout(location = 5) out vec3 seenFromOut;  // the reflection point, relative to the eye
#else
layout(location = 0) in vec3 position;
layout(location = 1) in vec4 normal;
layout(location = 2) in uint surface;
layout(location = 3) in vec4 relativeFromVehicle0;  // rows
layout(location = 4) in vec4 relativeFromVehicle1;
layout(location = 5) in vec4 relativeFromVehicle2;
layout(location = 6) in vec4 paint;                 // rgb; w: 1 braking
layout(location = 7) in vec4 map;                   // centre of the local map, relative; w: its cube
#endif

layout(location = 0) out vec3 relativeOut;
layout(location = 1) out vec3 normalOut;
layout(location = 2) out vec3 diffuseOut;   // outgoing radiance of the layer under the coat
layout(location = 3) out vec3 coatOut;      // F0; 1: a surface with a polished coat; sun
#ifdef REFLECTIVE
layout(location = 4) flat out vec4 mapOut;
#endif

void main() {
#ifdef VIRTUAL
    vec3 relative = (relativeFromMesh * vec4(position, 1.0)).xyz;
    vec3 n = normalize(mat3(relativeFromMesh) * normal);
    uint surface = uint(surfaceIndex + 0.5);
    gl_Position = clipFromVirtual * vec4(fromEye, 1.0);
    // The tangent plane at the reflection point halves the way from the vertex to its image.
    vec3 image = worldFromReflector * fromEye;
    vec3 across = image - relative;
    float along = dot(image, across);
    float t = 0.5 * dot(relative + image, across) / (abs(along) > 1e-6 ? along : 1e-6);
    seenFromOut = clamp(t, 0.0, 1.0) * image;
#else
    vec4 local = vec4(position, 1.0);
    vec3 relative = vec3(dot(relativeFromVehicle0, local), dot(relativeFromVehicle1, local), dot(relativeFromVehicle2, local));
    vec3 n = normalize(vec3(dot(relativeFromVehicle0.xyz, normal.xyz), dot(relativeFromVehicle1.xyz, normal.xyz),
                            dot(relativeFromVehicle2.xyz, normal.xyz)));
    gl_Position = frame.clipFromRelative * vec4(relative, 1.0);
#ifdef LAYERED
    gl_Layer = int(frame.eyeLow.w);
#endif
#endif
    vec4 s = surfaces[surface];
    vec3 albedo = surface == 0u || surface == 10u ? paint.rgb : s.rgb;
    // The sun's shadow is looked up per vertex: vertices are dense, and cars move from light to shade in a moment.
    vec3 world = relative + frame.eyeHigh.xyz + frame.eyeLow.xyz;
    float sun = texture(sunShadow, shadowCoordinate(world, n));
    vec3 light = ambientIrradiance(n, 0.85) + frame.sunIrradiance.rgb * (sun * max(dot(n, frame.sunDirection.xyz), 0.0));
    vec3 emission = vec3(0.0);
    if (surface == 5u) emission = vec3(6.0, 5.6, 5.0) * frame.skyIrradiance.w;
    if (surface == 6u) emission = vec3(1.6, 0.05, 0.03) * (1.4 * paint.w + 0.35 * frame.skyIrradiance.w);
    relativeOut = relative;
    normalOut = n;
    diffuseOut = albedo * light * inversePi + emission;
    coatOut = vec3(s.w, s.w >= 0.03 ? 1.0 : 0.0, sun);
#ifdef REFLECTIVE
    mapOut = map;
#endif
}
