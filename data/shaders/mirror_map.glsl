// What a planar mirror shows at a fragment: MirrorMap of reflection/gl/MirrorScene.h.
uniform vec4 uvFromFragment;  // scale xy, offset zw
uniform vec4 uvLimits;        // low xy, high zw
uniform vec2 blurredScale;    // from coordinates of mirrorColour to those of mirrorBlurred
layout(binding = 8) uniform sampler2D mirrorColour;
layout(binding = 9) uniform sampler2D mirrorBlurred;

vec2 mirrorUv(vec2 fragment) { return clamp(fragment * uvFromFragment.xy + uvFromFragment.zw, uvLimits.xy, uvLimits.zw); }

// A smooth mirror; `shift`: of a bumped one, in texture coordinates.
vec3 mirrorSharp(vec2 fragment, vec2 shift) {
    return textureLod(mirrorColour, clamp(mirrorUv(fragment) + shift, uvLimits.xy, uvLimits.zw), 0.0).rgb;
}

// Middles of the outermost texels in use of a level; `texel`: half of one of its texels.
vec2 mirrorBlurredFirst(vec2 texel) { return uvLimits.xy * blurredScale - 0.5 / vec2(textureSize(mirrorBlurred, 0)) + texel; }
vec2 mirrorBlurredLast(vec2 texel) { return uvLimits.zw * blurredScale + 0.5 / vec2(textureSize(mirrorBlurred, 0)) - texel; }

// Cubic B-spline of one level: four linear lookups; never blocky.
vec4 mirrorSmooth(vec2 uv, float level) {
    vec2 size = vec2(textureSize(mirrorBlurred, int(level)));
    vec2 at = uv * size - 0.5;
    vec2 base = floor(at), f = at - base;
    vec2 w0 = (1.0 - f) * (1.0 - f) * (1.0 - f) / 6.0, w3 = f * f * f / 6.0;
    vec2 w1 = (4.0 + f * f * (3.0 * f - 6.0)) / 6.0, w2 = 1.0 - w0 - w1 - w3;
    vec2 low = w0 + w1, high = w2 + w3;
    vec2 a = (base - 0.5 + w1 / low) / size, b = (base + 1.5 + w3 / high) / size;
    // Outside the part in use lies another reflection.
    vec2 texel = 0.5 / size;
    vec2 first = mirrorBlurredFirst(texel), last = mirrorBlurredLast(texel);
    a = clamp(a, first, max(last, first));
    b = clamp(b, first, max(last, first));
    return low.y * (low.x * textureLod(mirrorBlurred, a, level) + high.x * textureLod(mirrorBlurred, vec2(b.x, a.y), level)) +
           high.y * (low.x * textureLod(mirrorBlurred, vec2(a.x, b.y), level) + high.x * textureLod(mirrorBlurred, b, level));
}

// The image under a Gaussian of `sigma` texels: between the two levels next to it, in the variance.
// Level k under the spline has the variance (4^k - 1) / 4 + 4^k / 3.
vec4 mirrorGaussian(vec2 uv, float sigma, int levels) {
    float variance = sigma * sigma;
    const float first = 1.0 / 3.0;
    if (variance < first)
        return mix(textureLod(mirrorBlurred, uv, 0.0), mirrorSmooth(uv, 0.0), variance / first);
    float level = min(floor(0.5 * log2((variance + 0.25) / (7.0 / 12.0))), float(levels - 2));
    float power = exp2(2.0 * level);
    float from = 7.0 / 12.0 * power - 0.25, to = 7.0 / 3.0 * power - 0.25;
    return mix(mirrorSmooth(uv, level), mirrorSmooth(uv, level + 1.0), clamp((variance - from) / (to - from), 0.0, 1.0));
}

// The same by linear lookups, a fourth of the cost, for sums of several. Level k has the variance (4^k - 1) / 4 + 4^k / 6.
vec4 mirrorQuick(vec2 uv, float sigma, int levels) {
    float level = 0.5 * log2(max((sigma * sigma + 0.25) / (5.0 / 12.0), 1.0));
    level = min(level, float(levels - 1));
    vec2 texel = 0.5 / vec2(textureSize(mirrorBlurred, int(ceil(level))));
    vec2 first = mirrorBlurredFirst(texel), last = mirrorBlurredLast(texel);
    return textureLod(mirrorBlurred, clamp(uv, first, max(last, first)), level);
}

// A rough mirror at a place of mirrorBlurred. `along`, `across`: texture coordinates by which the image moves when the reflected direction turns
// by one standard deviation within the plane of incidence, and across it, for something far behind the glass. `levels`: MirrorMap::blurLevels.
vec3 mirrorGlossAt(vec2 uv, vec4 limits, vec2 along, vec2 across, int levels) {
    vec2 size = vec2(textureSize(mirrorBlurred, 0));
    float longest = length(along * size), shortest = min(length(across * size), longest);
    // How far behind the glass what is seen lies: of the neighbourhood that could be mixed in, then of that which is.
    float behind = mirrorQuick(uv, 0.5 * shortest, levels).a;
    behind = mirrorQuick(uv, behind * shortest, levels).a;
    float sigma = behind * shortest;
    // The rest of the spread along the plane of incidence: seven lookups with binomial weights, of variance 6/4.
    float rest = sqrt(max(longest * longest - shortest * shortest, 0.0)) * behind;
    if (rest < 0.5 * sigma + 0.25) return mirrorGaussian(uv, sigma, levels).rgb;
    vec2 stride = along / max(longest, 1e-6) * rest / sqrt(1.5);
    const float weights[4] = float[4](20.0 / 64.0, 15.0 / 64.0, 6.0 / 64.0, 1.0 / 64.0);
    sigma = max(sigma, 0.4 * length(stride * size));  // no gaps between the lookups
    vec3 sum = weights[0] * mirrorQuick(uv, sigma, levels).rgb;
    for (int i = 1; i < 4; ++i) {
        vec2 low = clamp(uv - float(i) * stride, limits.xy, limits.zw), high = clamp(uv + float(i) * stride, limits.xy, limits.zw);
        sum += weights[i] * (mirrorQuick(low, sigma, levels).rgb + mirrorQuick(high, sigma, levels).rgb);
    }
    return sum;
}

// The same for mirrors that show little of what they mirror, four or five lookups in place of ten to sixteen: what is mixed in is as far behind
// the glass as the neighbourhood, and the rest of the spread along the plane of incidence three lookups.
vec3 mirrorGlossDim(vec2 fragment, vec2 along, vec2 across, int levels) {
    vec4 limits = uvLimits * blurredScale.xyxy;
    vec2 uv = clamp(mirrorUv(fragment) * blurredScale, limits.xy, limits.zw);
    along *= blurredScale;
    across *= blurredScale;
    vec2 size = vec2(textureSize(mirrorBlurred, 0));
    float longest = length(along * size), shortest = min(length(across * size), longest);
    float behind = mirrorQuick(uv, 0.5 * shortest, levels).a;
    float rest = sqrt(max(longest * longest - shortest * shortest, 0.0)) * behind;
    // Three lookups with weights 1 4 1 have a variance of a third of the stride's square.
    vec2 stride = along / max(longest, 1e-6) * rest * 1.7320508;
    float sigma = max(behind * shortest, 0.4 * length(stride * size));
    vec3 sum = 4.0 * mirrorQuick(uv, sigma, levels).rgb;
    sum += mirrorQuick(clamp(uv - stride, limits.xy, limits.zw), sigma, levels).rgb;
    sum += mirrorQuick(clamp(uv + stride, limits.xy, limits.zw), sigma, levels).rgb;
    return sum / 6.0;
}

// The same at a fragment, coordinates those of mirrorColour.
vec3 mirrorGloss(vec2 fragment, vec2 shift, vec2 along, vec2 across, int levels) {
    vec4 limits = uvLimits * blurredScale.xyxy;
    vec2 uv = clamp((mirrorUv(fragment) + shift) * blurredScale, limits.xy, limits.zw);
    return mirrorGlossAt(uv, limits, along * blurredScale, across * blurredScale, levels);
}

// Texture coordinates by which an image moves when a direction `v` of its view space turns towards `e`, for one radian; `uvPerTangent`: for
// one unit of x / -z.
vec2 mirrorMovement(vec3 v, vec3 e, vec2 uvPerTangent) { return (v.xy * e.z - e.xy * v.z) / (v.z * v.z) * uvPerTangent; }

// The spread of a rough mirror about a direction `d` from the eye to it, of unit length, in the plane of incidence and across it: xyz turns of `d`
// by one standard deviation, `angle` of reflection/planar/Gloss.h. `n`: the mirror's normal, on the eye's side.
void mirrorSpread(vec3 d, vec3 n, float angle, out vec3 along, out vec3 across) {
    float facing = clamp(-dot(d, n), 1e-3, 1.0);
    vec3 within = n + facing * d;
    float size = length(within);
    vec3 e1 = size > 1e-4 ? within / size : normalize(cross(d, abs(d.z) < 0.9 ? vec3(0, 0, 1) : vec3(1, 0, 0)));
    along = angle * e1;
    across = angle * facing * cross(d, e1);
}
