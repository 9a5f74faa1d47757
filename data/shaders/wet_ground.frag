#version 450 core
// Streets after rain: water darkens them, and mirrors by Fresnel's law; smooth in puddles, where ripples move the image, rough in between.
// Drawn over the dry ground; MIRROR: with what the road's plane mirrors; without: with mean light and the sun.
#include "frame.glsl"
#include "output.glsl"
#ifdef MIRROR
#include "mirror_map.glsl"
#endif

layout(binding = 1) uniform sampler2DShadow sunShadow;
layout(binding = 0) uniform sampler2DArray patterns;
#ifdef MIRROR
uniform float planeHeight;  // of the mirror, metres above the eye
uniform vec2 uvPerRadian;   // of the map, near the middle of the image
uniform vec2 uvPerNdc;      // of the map, over the view
uniform int blurLevels;     // 0: no blurred map, all water is smooth
#endif
uniform float filmAngle;    // radians: standard deviation of what the film of water on rough asphalt mirrors

layout(location = 0) in vec2 texcoord;
layout(location = 1) flat in float layer;
layout(location = 2) in vec3 shaded;
layout(location = 3) in vec3 sunlit;
layout(location = 4) in vec3 shadowCoordinate;
layout(location = 5) in vec3 relative;
layout(location = 6) in vec3 normal;

const float grass = 4.0, soil = 5.0;    // city::Pattern
const float waterReflectance = 0.02;
const float reachOfPlane = 0.4;         // metres above or below the mirror at which its image is no longer used

float hash(vec2 p) {
    vec3 q = fract(vec3(p.xyx) * 0.1031);
    q += dot(q, q.yzx + 33.33);
    return fract((q.x + q.y) * q.z);
}
float noise(vec2 p) {
    vec2 i = floor(p), f = p - i;
    f = f * f * (3.0 - 2.0 * f);
    return mix(mix(hash(i), hash(i + vec2(1.0, 0.0)), f.x), mix(hash(i + vec2(0.0, 1.0)), hash(i + vec2(1.0, 1.0)), f.x), f.y);
}

void main() {
    vec4 texel = texture(patterns, vec3(texcoord, layer));
    vec3 dry = texel.rgb * texel.rgb * (shaded + sunlit * texture(sunShadow, shadowCoordinate));
    vec3 towardsEye = -normalize(relative);
    vec2 place = relative.xy + frame.eyeHigh.xy + frame.eyeLow.xy;
    bool soaks = layer > grass - 0.5 && layer < soil + 0.5;
#ifdef MIRROR
    float level = 1.0 - smoothstep(0.7, 1.0, abs(relative.z - planeHeight) / reachOfPlane);
#else
    const float level = 1.0;
#endif
    float lies = soaks ? 0.0 : smoothstep(0.95, 0.999, normal.z) * level;
    // Puddles: where the ground, lower here and there, fills.
    float low = 0.6 * noise(place * 0.21) + 0.28 * noise(place * 0.83 + 7.0) + 0.12 * noise(place * 3.1 + 3.0);
    float puddle = smoothstep(0.54, 0.6, low) * lies;
    vec3 under = dry * mix(soaks ? 0.75 : 0.62, 0.45, puddle);

    float grazing = 1.0 - max(towardsEye.z, 0.0);
    float grazing2 = grazing * grazing;
    float fresnel = waterReflectance + (1.0 - waterReflectance) * grazing2 * grazing2 * grazing;
#ifdef MIRROR
    // Ripples: slopes of a degree turn the mirrored ray by two.
    float distance = length(relative);
    vec2 slope = 0.018 * (vec2(noise(place * 9.0), noise(place * 9.0 + 19.0)) - 0.5) / (1.0 + 0.05 * distance);
    vec2 right = normalize(vec2(-relative.y, relative.x) + vec2(1e-6, 0.0));
    vec2 ripple = 2.0 * uvPerRadian * vec2(-dot(slope, right), dot(slope, normalize(relative.xy + vec2(1e-6, 0.0))));
    // Ground that lies e above the mirror shows at its place what the map shows 2 e lower: all of it for what touches the ground, none
    // for what is far away, and in between by the share of the way that lies before the ground. First as if something touched it: that
    // tells how far what is there lies.
    vec4 clip = frame.clipFromRelative * vec4(relative, 1.0);
    vec4 lower = clip - frame.clipFromRelative[2] * (2.0 * clamp(relative.z - planeHeight, -reachOfPlane, reachOfPlane));
    vec2 full = (lower.xy / lower.w - clip.xy / clip.w) * uvPerNdc;
    vec2 shift = full;
    if (blurLevels > 0)
        for (int i = 0; i < 2; ++i) {
            vec2 at = clamp(mirrorUv(gl_FragCoord.xy) + shift, uvLimits.xy, uvLimits.zw) * blurredScale;
            shift = full * (1.0 - clamp(textureLod(mirrorBlurred, at, 0.0).a, 0.0, 1.0));
        }
    vec3 smoothImage = mirrorSharp(gl_FragCoord.xy, ripple + shift);
    vec3 film = smoothImage;
    // The plane of incidence of a level mirror is upright in the picture.
    if (blurLevels > 0 && puddle < 0.99 && lies > 0.01)
        film = mirrorGloss(gl_FragCoord.xy, shift, vec2(0.0, filmAngle * uvPerRadian.y),
                           vec2(filmAngle * max(towardsEye.z, 0.05) * uvPerRadian.x, 0.0), blurLevels);
    // Grains that stick out of the film hide some of it from low eyes.
    vec3 mirrored = mix(0.7 * film, smoothImage, puddle);
#else
    vec3 reflected = vec3(-towardsEye.xy, towardsEye.z);
    vec3 mirrored = mix(frame.groundIrradiance.rgb, frame.skyIrradiance.rgb, clamp(reflected.z * 2.0 + 0.5, 0.0, 1.0)) * (inversePi * 0.8);
    // The sun in the film: a Gaussian of its angle.
    float apart = acos(clamp(dot(reflected, frame.sunDirection.xyz), -1.0, 1.0)) / filmAngle;
    mirrored += frame.sunIrradiance.rgb * (exp(-0.5 * apart * apart) * (1.0 - puddle) * 0.15915494 / (filmAngle * filmAngle) *
                                           texture(sunShadow, shadowCoordinate));
#endif
    vec3 radiance = under * (1.0 - fresnel * lies) + mirrored * (fresnel * lies);
#ifdef CUBE
    writePixel(radiance, relative);
#else
    writePixel(radiance);
#endif
}
