#version 450 core
#include "frame.glsl"
#include "output.glsl"

layout(location = 0) in vec3 relative;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 diffuse;
layout(location = 3) in vec3 coat;
#ifdef REFLECTIVE
layout(location = 4) flat in vec4 map;  // centre of the local map, relative to the eye; w: its cube
layout(binding = 2) uniform samplerCubeArray localMap;
#endif
#ifdef PARALLAX
#include "parallax.glsl"
#endif
#ifdef VIRTUAL
layout(location = 5) in vec3 seenFrom;
#else
const vec3 seenFrom = vec3(0.0);
#endif
#ifdef VIRTUAL
uniform bool bounced;  // its chrome, seen in other chrome, shows close things too: as in views
#endif
#if defined CHROME || defined VIRTUAL
// What chrome in this view shows of things close to it, and how far away that chrome is (reversed depth).
layout(binding = 5) uniform sampler2D closeLight;
layout(binding = 6) uniform sampler2D closeDepth;
#endif
#ifdef SCREEN
layout(binding = 3) uniform sampler2D screenLight;  // what this pixel mirrors
#endif

void main() {
    vec3 towardsEye = normalize(seenFrom - relative);
    vec3 n = normalize(normal);
    float facing = max(dot(n, towardsEye), 0.0);
    float grazing = 1.0 - facing;
    float grazing2 = grazing * grazing;
    float fresnel = coat.x + (1.0 - coat.x) * coat.y * grazing2 * grazing2 * grazing;  // Schlick
    vec3 reflected = 2.0 * dot(n, towardsEye) * n - towardsEye;
#if defined CHROME || defined VIRTUAL
    // Of this very part: within a twentieth of its distance, more than a level of detail is off by.
    vec4 close = vec4(0.0);
#ifdef VIRTUAL
    if (bounced && coat.x > 0.6) {
#else
    if (coat.x > 0.6) {
#endif
        float depth = texelFetch(closeDepth, ivec2(gl_FragCoord.xy), 0).r;
        if (abs(depth - gl_FragCoord.z) < 0.05 * gl_FragCoord.z) close = texelFetch(closeLight, ivec2(gl_FragCoord.xy), 0);
    }
#endif
#if defined SCREEN
    vec3 mirrored = texelFetch(screenLight, ivec2(gl_FragCoord.xy), 0).rgb;
#elif defined REFLECTIVE
    // The level whose texels are as wide as what the pixel reflects: derivatives of the reflected direction, not of face coordinates, which
    // jump at edges. A face of n texels spans two units.
    vec3 dx = dFdx(reflected), dy = dFdy(reflected);
#ifdef PARALLAX
    vec3 from = relative - map.xyz, fromX = dFdx(from), fromY = dFdy(from);
#endif
    vec3 mirrored = vec3(0.0);
#if defined CHROME || defined VIRTUAL
    if (close.a < 1.0)
#endif
    {
        vec3 direction = reflected;
#ifdef PARALLAX
        float near = nearnessOfHit(from, reflected, map.w);
        direction += near * from;
        vec3 across = max(abs(dx + near * fromX), abs(dy + near * fromY));
#else
        vec3 across = max(abs(dx), abs(dy));
#endif
        float wide = max(max(across.x, across.y), across.z) * 0.5 * float(textureSize(localMap, 0).x);
        float level = max(log2(max(wide, 1e-4)), coat.x > 0.3 && coat.x < 0.5 ? 2.0 : 0.0);  // rims are brushed
        mirrored = textureLod(localMap, vec4(direction, map.w), level).rgb;
    }
#else
    // No map: the sky's mean above, the ground's below.
    float up = clamp(reflected.z * 2.0 + 0.5, 0.0, 1.0);
    vec3 mirrored = mix(frame.groundIrradiance.rgb, frame.skyIrradiance.rgb, up) * (inversePi * 0.8);
    float glint = max(dot(reflected, frame.sunDirection.xyz), 0.0);
    glint *= glint; glint *= glint; glint *= glint; glint *= glint; glint *= glint; glint *= glint; glint *= glint;
    mirrored += frame.sunIrradiance.rgb * (8.0 * glint * coat.y * coat.z);
#endif
#if defined CHROME || defined VIRTUAL
    mirrored = mix(mirrored, close.rgb, close.a);
#endif
    vec3 radiance = diffuse * (1.0 - fresnel) + mirrored * fresnel;
#if defined CUBE || defined VIRTUAL
    writePixel(radiance, relative);
#else
    writePixel(radiance);
#endif
}
