#version 450 core
// Antialiasing after the fact, after Lottes 2009 (FXAA 3, quality path with fewer search steps), in two passes: FIND marks pixels on
// edges in the depth buffer, the other, drawn where the mark is, works on those alone. A `discard` instead would not do: a software rasteriser
// goes on computing what is discarded, but skips blocks of pixels that fail an early depth test.
layout(binding = 3) uniform sampler2D image;
uniform vec2 texel;  // 1 / size
uniform ivec2 last;  // the last pixel drawn
#ifndef FIND
layout(location = 0) out vec4 colourOut;
#endif

const float edgeThreshold = 0.125;      // share of the local maximum
const float edgeThresholdDark = 0.0312;  // absolute
const int searchSteps = 6;
const float searchStride[6] = float[6](1.0, 1.5, 2.0, 2.0, 4.0, 8.0);

float luma(vec2 at) { return dot(textureLod(image, min(at, (vec2(last) + 0.5) * texel), 0.0).rgb, vec3(0.299, 0.587, 0.114)); }

// Unfiltered: several times cheaper in software. Outside the image, its border.
float lumaAt(ivec2 at) { return dot(texelFetch(image, clamp(at, ivec2(0), last), 0).rgb, vec3(0.299, 0.587, 0.114)); }

void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    float m = lumaAt(here);
    float n = lumaAt(here + ivec2(0, 1));
    float s = lumaAt(here - ivec2(0, 1));
    float e = lumaAt(here + ivec2(1, 0));
    float w = lumaAt(here - ivec2(1, 0));
    float highest = max(max(max(n, s), max(e, w)), m);
    float lowest = min(min(min(n, s), min(e, w)), m);
    float range = highest - lowest;
#ifdef FIND
    if (range < max(edgeThresholdDark, highest * edgeThreshold)) discard;
#else
    float ne = lumaAt(here + ivec2(1, 1));
    float sw = lumaAt(here - ivec2(1, 1));
    float nw = lumaAt(here + ivec2(-1, 1));
    float se = lumaAt(here + ivec2(1, -1));
    vec2 at = gl_FragCoord.xy * texel;

    // Blend single pixels that stick out of their surroundings.
    float average = (2.0 * (n + s + e + w) + ne + nw + se + sw) / 12.0;
    float sticking = smoothstep(0.0, 1.0, clamp(abs(average - m) / range, 0.0, 1.0));
    float subpixel = 0.75 * sticking * sticking;

    bool horizontal = 2.0 * abs(n + s - 2.0 * m) + abs(ne + se - 2.0 * e) + abs(nw + sw - 2.0 * w) >=
                      2.0 * abs(e + w - 2.0 * m) + abs(ne + nw - 2.0 * n) + abs(se + sw - 2.0 * s);
    float positive = horizontal ? n : e;
    float negative = horizontal ? s : w;
    float gradientPositive = abs(positive - m);
    float gradientNegative = abs(negative - m);
    float gradient = max(gradientPositive, gradientNegative);
    vec2 across = horizontal ? vec2(0.0, texel.y) : vec2(texel.x, 0.0);
    float other = positive;
    if (gradientNegative > gradientPositive) {
        across = -across;
        other = negative;
    }
    float onEdge = 0.5 * (m + other);

    // Walk along the edge both ways to its ends.
    vec2 along = horizontal ? vec2(texel.x, 0.0) : vec2(0.0, texel.y);
    vec2 start = at + 0.5 * across;
    float limit = 0.25 * gradient;
    float forward = 0.0;
    float backward = 0.0;
    float endForward = 0.0;
    float endBackward = 0.0;
    bool openForward = true;
    bool openBackward = true;
    for (int i = 0; i < searchSteps && (openForward || openBackward); ++i) {
        if (openForward) {
            forward += searchStride[i];
            endForward = luma(start + forward * along) - onEdge;
            openForward = abs(endForward) < limit;
        }
        if (openBackward) {
            backward += searchStride[i];
            endBackward = luma(start - backward * along) - onEdge;
            openBackward = abs(endBackward) < limit;
        }
    }
    float nearest = min(forward, backward);
    float nearestEnd = forward < backward ? endForward : endBackward;
    bool wrongSide = (nearestEnd < 0.0) == (m - onEdge < 0.0);
    float edge = wrongSide ? 0.0 : 0.5 - nearest / (forward + backward);
    colourOut = vec4(textureLod(image, at + max(edge, subpixel) * across, 0.0).rgb, 1.0);
#endif
}
