#version 450 core
// The pixels of a piece of chrome take what its layer holds, and where that is nothing what is far away, from the local map. They hide what is
// behind them. MASK: depth alone.
#ifdef MASK
void main() {}
#else
layout(location = 0) in vec3 relative;
layout(location = 1) in vec3 normal;
layout(binding = 5) uniform sampler2D chromeLayer;
uniform float share;  // over what the vehicle's own shading takes from the local map
layout(location = 0) out vec4 colourOut;

#ifdef REFLECTIVE
uniform vec4 map;  // centre of the local map, relative to the eye; w: its cube
layout(binding = 2) uniform samplerCubeArray localMap;
#ifdef PARALLAX
#include "parallax.glsl"
#endif

// A pixel of curved chrome takes in a strip of its surroundings: many times as wide as high on a pillar. The level fits the strip's narrow side,
// and so many lookups at most lie along it.
const int mostAlong = 8;

vec3 farLight() {
    vec3 n = normalize(normal), towards = normalize(relative);
    vec3 reflected = towards - 2.0 * dot(n, towards) * n;
    vec3 direction = reflected, dx = dFdx(reflected), dy = dFdy(reflected);
#ifdef PARALLAX
    vec3 from = relative - map.xyz;
    float near = nearnessOfHit(from, reflected, map.w);
    direction += near * from;
    dx += near * dFdx(from);
    dy += near * dFdy(from);
#endif
    // The footprint's axes: of the ellipse that a circle of a pixel's size becomes.
    float xx = dot(dx, dx), xy = dot(dx, dy), yy = dot(dy, dy);
    float middle = 0.5 * (xx + yy), apart = length(vec2(0.5 * (xx - yy), xy));
    float longest = middle + apart;
    vec2 along = abs(xy) > 1e-12 ? normalize(vec2(xy, longest - xx)) : xx >= yy ? vec2(1.0, 0.0) : vec2(0.0, 1.0);
    vec3 strip = along.x * dx + along.y * dy;
    float perTexel = 0.5 * float(textureSize(localMap, 0).x);
    float wide = max(sqrt(longest) * perTexel, 1e-4), high = sqrt(max(middle - apart, 0.0)) * perTexel;
    float narrow = max(high, 1.0);
    int count = clamp(int(ceil(wide / narrow)), 1, mostAlong);
    float level = log2(max(narrow, wide / float(count)));
    vec3 sum = vec3(0.0);
    for (int k = 0; k < count; ++k)
        sum += textureLod(localMap, vec4(direction + ((float(k) + 0.5) / float(count) - 0.5) * strip, map.w), level).rgb;
    return sum / float(count);
}
#endif

void main() {
    vec4 close = texelFetch(chromeLayer, ivec2(gl_FragCoord.xy), 0);
#ifdef REFLECTIVE
    vec3 light = close.rgb;
    if (close.a < 1.0) light = mix(farLight(), close.rgb, close.a);
    colourOut = vec4(light, share);
#else
    colourOut = vec4(close.rgb, share * close.a);
#endif
}
#endif
