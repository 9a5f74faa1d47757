#version 450 core
#include "frame.glsl"
#include "output.glsl"

layout(binding = 1) uniform sampler2DShadow sunShadow;
layout(binding = 0) uniform sampler2DArray patterns;  // square roots of albedos: linear enough to filter, quick to decode

layout(location = 0) in vec2 texcoord;
layout(location = 1) flat in float layer;
layout(location = 2) in vec3 shaded;
layout(location = 3) in vec3 sunlit;
layout(location = 4) in vec3 shadowCoordinate;
#if defined CUBE || defined VIRTUAL
layout(location = 5) in vec3 relative;
#endif

void main() {
    vec4 texel = texture(patterns, vec3(texcoord, layer));
#ifdef CUTOUT
    if (texel.a < 0.5) discard;
#endif
    vec3 radiance = texel.rgb * texel.rgb * (shaded + sunlit * texture(sunShadow, shadowCoordinate));
#if defined CUBE || defined VIRTUAL
    writePixel(radiance, relative);
#else
    writePixel(radiance);
#endif
}
