#version 450 core
// Glass and polished stone: what lies behind or within and what is mirrored, mixed by Fresnel's law. MIRROR: with a reflection map; without:
// from mean light. ROUGH: the map blurred, the more the farther behind the surface things are seen.
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
layout(location = 8) flat in float gloss;  // radians
#ifdef ROUGH
uniform mat3 viewFromRelative;  // of the image in which the surface is met
uniform vec2 uvPerTangent;      // texture coordinates for one unit of x / -z in view space
uniform int blurLevels;
#endif

void main() {
    vec4 texel = texture(patterns, vec3(texcoord, layer));
    vec3 behind = texel.rgb * texel.rgb * (shaded + sunlit * texture(sunShadow, shadowCoordinate));
    vec3 towardsEye = -normalize(relative);
    float facing = max(dot(normal, towardsEye), 0.0);
    float grazing = 1.0 - facing;
    float grazing2 = grazing * grazing;
    float more = grazing2 * grazing2 * grazing;  // Schlick
    float fresnel = glass.x + (1.0 - glass.x) * more;
#ifdef ROUGH
    vec3 along, across;
    mirrorSpread(-towardsEye, normal, gloss, along, across);
    vec3 v = viewFromRelative * -towardsEye;
    vec3 mirrored = mirrorGlossDim(gl_FragCoord.xy, mirrorMovement(v, viewFromRelative * along, uvPerTangent),
                                mirrorMovement(v, viewFromRelative * across, uvPerTangent), blurLevels);
#elif defined MIRROR
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
