#version 450 core
// The pyramid of a mirror map that rough mirrors are drawn from. FIRST: colour, and the share of the way from the eye behind the glass
// that lies behind the glass. Otherwise one level from the next finer one, by the binomial filter 1 3 3 1 in both directions, as four
// linear lookups: each level is the image under a smooth kernel, with a variance of (4^k - 1) / 4 texels of level 0.
layout(location = 0) out vec4 blurredOut;
#ifdef FIRST
layout(binding = 0) uniform sampler2D colourMap;
layout(binding = 1) uniform sampler2D distanceMap;  // metres from the eye
uniform vec3 rayBase, rayRight, rayUp;              // world direction of a fragment: base + x * right + y * up
uniform vec4 glass;                                 // dot(xyz, p - eye) + w >= 0 in front of it, unit normal

void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    vec3 ray = normalize(rayBase + gl_FragCoord.x * rayRight + gl_FragCoord.y * rayUp);
    float before = -glass.w / max(dot(glass.xyz, ray), 1e-6);
    float way = texelFetch(distanceMap, here, 0).r;
    float behind = isinf(way) ? 1.0 : clamp(1.0 - before / max(way, 1e-6), 0.0, 1.0);
    blurredOut = vec4(texelFetch(colourMap, here, 0).rgb, behind);
}
#else
layout(binding = 0) uniform sampler2D finer;
uniform float finerLevel;
uniform vec2 finerTexel;  // 1 / size of the finer level
uniform vec4 limits;      // middles of the outermost texels in use, in texture coordinates: low xy, high zw

void main() {
    vec2 at = 2.0 * gl_FragCoord.xy * finerTexel;
    vec2 low = clamp(at - 0.75 * finerTexel, limits.xy, limits.zw), high = clamp(at + 0.75 * finerTexel, limits.xy, limits.zw);
    blurredOut = 0.25 * (textureLod(finer, low, finerLevel) + textureLod(finer, high, finerLevel) +
                         textureLod(finer, vec2(low.x, high.y), finerLevel) + textureLod(finer, vec2(high.x, low.y), finerLevel));
}
#endif
