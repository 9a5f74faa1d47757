#version 450 core
// Glass: what lies behind it and what it mirrors, mixed by Fresnel's law. MIRROR: with a reflection map; without: from mean light.
#include "frame.glsl"
#include "output.glsl"
#ifdef MIRROR
#include "mirror_map.glsl"
#endif

layout(binding = 1) uniform sampler2DShadow sunShadow;
layout(binding = 0) uniform sampler2DArray patterns;

layout(location = 0) in vec2 texcoord;
layout(location = 1) flat in float layer;
layout(location = 2) in vec3 shaded;
layout(location = 3) in vec3 sunlit;
layout(location = 4) in vec3 shadowCoordinate;
layout(location = 5) in vec3 relative;
layout(location = 6) flat in vec3 normal;
layout(location = 7) flat in vec2 glass;  // reflectance, transmittance at normal incidence

void main() {
    vec4 texel = texture(patterns, vec3(texcoord, layer));
    vec3 behind = texel.rgb * texel.rgb * (shaded + sunlit * texture(sunShadow, shadowCoordinate));
    vec3 towardsEye = -normalize(relative);
    float facing = max(dot(normal, towardsEye), 0.0);
    float grazing = 1.0 - facing;
    float grazing2 = grazing * grazing;
    float more = grazing2 * grazing2 * grazing;  // Schlick
    float fresnel = glass.x + (1.0 - glass.x) * more;
#ifdef MIRROR
    vec3 mirrored = mirrorSharp(gl_FragCoord.xy, vec2(0.0));
#else
    vec3 reflected = 2.0 * facing * normal - towardsEye;
    float up = clamp(reflected.z * 2.0 + 0.5, 0.0, 1.0);
    vec3 mirrored = mix(frame.groundIrradiance.rgb, frame.skyIrradiance.rgb, up) * (inversePi * 0.8);
#endif
    vec3 radiance = behind * (glass.y * (1.0 - more)) + mirrored * fresnel;
#ifdef CUBE
    writePixel(radiance, relative);
#else
    writePixel(radiance);
#endif
}
