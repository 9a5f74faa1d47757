#version 450 core
#include "frame.glsl"
#include "output.glsl"

layout(location = 0) in vec3 relative;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 diffuse;
layout(location = 3) in vec3 coat;
#ifdef REFLECTIVE
layout(location = 4) flat in float mapLayer;
layout(binding = 2) uniform samplerCubeArray localMap;
#endif
#ifdef SCREEN
layout(binding = 3) uniform sampler2D screenLight;  // what this pixel mirrors
#endif

void main() {
    vec3 towardsEye = -normalize(relative);
    vec3 n = normalize(normal);
    float facing = max(dot(n, towardsEye), 0.0);
    float grazing = 1.0 - facing;
    float grazing2 = grazing * grazing;
    float fresnel = coat.x + (1.0 - coat.x) * coat.y * grazing2 * grazing2 * grazing;  // Schlick
    vec3 reflected = 2.0 * dot(n, towardsEye) * n - towardsEye;
#if defined SCREEN
    vec3 mirrored = texelFetch(screenLight, ivec2(gl_FragCoord.xy), 0).rgb;
#elif defined REFLECTIVE
    // The level whose texels are as wide as what the pixel reflects: derivatives of the reflected direction, not of face coordinates, which
    // jump at edges. A face of n texels spans two units.
    vec3 across = max(abs(dFdx(reflected)), abs(dFdy(reflected)));
    float wide = max(max(across.x, across.y), across.z) * 0.5 * float(textureSize(localMap, 0).x);
    float level = max(log2(max(wide, 1e-4)), coat.x > 0.3 && coat.x < 0.5 ? 2.0 : 0.0);  // rims are brushed
    vec3 mirrored = textureLod(localMap, vec4(reflected, mapLayer), level).rgb;
#else
    // No map: the sky's mean above, the ground's below.
    float up = clamp(reflected.z * 2.0 + 0.5, 0.0, 1.0);
    vec3 mirrored = mix(frame.groundIrradiance.rgb, frame.skyIrradiance.rgb, up) * (inversePi * 0.8);
    float glint = max(dot(reflected, frame.sunDirection.xyz), 0.0);
    glint *= glint; glint *= glint; glint *= glint; glint *= glint; glint *= glint; glint *= glint; glint *= glint;
    mirrored += frame.sunIrradiance.rgb * (8.0 * glint * coat.y * coat.z);
#endif
    vec3 radiance = diffuse * (1.0 - fresnel) + mirrored * fresnel;
#ifdef CUBE
    writePixel(radiance, relative);
#else
    writePixel(radiance);
#endif
}
