#version 450 core
// Streets after rain: water darkens them, and mirrors by Fresnel's law; smooth in puddles, where ripples move the image, rough in between.
// Drawn over the dry ground; MIRROR: with what the road's plane mirrors; without: with mean light and the sun. Twin of app::wetGround, which
// gives the numbers WET_...
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

layout(location = 0) in vec2 texcoord;
layout(location = 1) flat in float layer;
layout(location = 2) in vec3 shaded;
layout(location = 3) in vec3 sunlit;
layout(location = 4) in vec3 shadowCoordinate;
layout(location = 5) in vec3 relative;
layout(location = 6) in vec3 normal;

const float filmAngle = WET_FILM_ANGLE;  // radians: standard deviation of what the film of water on rough asphalt mirrors
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
    bool soaks = layer > WET_GRASS - 0.5 && layer < WET_SOIL + 0.5;
#ifdef MIRROR
    float level = 1.0 - smoothstep(0.7, 1.0, abs(relative.z - planeHeight) / reachOfPlane);
#else
    const float level = 1.0;
#endif
    float lies = soaks ? 0.0 : smoothstep(WET_SLOPE_DRY, WET_SLOPE_WET, normal.z) * level;
    // Puddles: where the ground, lower here and there, fills.
    float low = 0.6 * noise(place * 0.21) + 0.28 * noise(place * 0.83 + 7.0) + 0.12 * noise(place * 3.1 + 3.0);
    float puddle = smoothstep(WET_PUDDLE_FROM, WET_PUDDLE_TO, low) * lies;
    vec3 under = dry * mix(soaks ? WET_SOAKED_SHADE : WET_FILM_SHADE, WET_PUDDLE_SHADE, puddle);

    float grazing = 1.0 - max(towardsEye.z, 0.0);
    float grazing2 = grazing * grazing;
    float fresnel = WET_REFLECTANCE + (1.0 - WET_REFLECTANCE) * grazing2 * grazing2 * grazing;
#ifdef MIRROR
    // Ripples: slopes of a degree turn the mirrored ray by two.
    float distance = length(relative);
    vec2 ripples = place * WET_RIPPLES_PER_METRE;
    vec2 slope = WET_RIPPLE_SLOPE * (vec2(noise(ripples), noise(ripples + 19.0)) - 0.5) / (1.0 + WET_RIPPLE_FADE * distance);
    vec3 rippled = reflect(-towardsEye, normalize(vec3(slope, 1.0)));
    vec4 straight = frame.clipFromRelative * vec4(-towardsEye, 0.0), bent = frame.clipFromRelative * vec4(rippled.xy, -abs(rippled.z), 0.0);
    vec2 ripple = (bent.xy / max(bent.w, 1e-3) - straight.xy / max(straight.w, 1e-3)) * uvPerNdc;
    // Ground that lies e above the mirror shows at its place what the map shows 2 e lower: all of it for what touches the ground, none
    // for what is far away, and in between by the share of the way that lies before the ground. First as if something touched it: that
    // tells how far what is there lies.
    vec4 clip = frame.clipFromRelative * vec4(relative, 1.0);
    vec4 lower = clip - frame.clipFromRelative[2] * (2.0 * clamp(relative.z - planeHeight, -reachOfPlane, reachOfPlane));
    vec2 full = (lower.xy / lower.w - clip.xy / clip.w) * uvPerNdc;
    vec2 shift = full;
    float behind = 1.0;  // share of the way that lies behind the water
    if (blurLevels > 0) {
        float above = clamp(relative.z - planeHeight, -reachOfPlane, reachOfPlane), before = 1.0;
        int looks = abs(above) > 0.01 ? 3 : 1;
        for (int i = 0; i < looks; ++i) {
            vec2 at = clamp(mirrorUv(gl_FragCoord.xy) + full * before, uvLimits.xy, uvLimits.zw) * blurredScale;
            // The map knows what share of the way lies behind the mirror's plane: that is not where the ground is.
            float way = 1.0 - clamp(textureLod(mirrorBlurred, at, 0.0).a, 0.0, 1.0);
            float found = way * clamp(1.0 + above * (1.0 - 2.0 * before) / planeHeight, 0.0, 2.0);
            // Nearer than the ground itself, as the kerb before a pavement: not what the ground mirrors. Nor is what comes and goes with
            // every look: then what is far away.
            bool wrong = found > 1.005 || (i == 2 && abs(found - before) > 0.2);
            before = wrong ? 0.0 : min(found, 1.0);
        }
        shift = full * before;
        behind = 1.0 - before;
    }
    vec3 smoothImage = mirrorSharp(gl_FragCoord.xy, ripple * behind + shift);
    vec3 film = smoothImage;
    // The plane of incidence of a level mirror is upright in the picture.
    if (blurLevels > 0 && puddle < 0.99 && lies > 0.01)
        film = mirrorGloss(gl_FragCoord.xy, shift, vec2(0.0, filmAngle * uvPerRadian.y),
                           vec2(filmAngle * max(towardsEye.z, 0.05) * uvPerRadian.x, 0.0), blurLevels);
    // Grains that stick out of the film hide some of it from low eyes.
    vec3 mirrored = mix(WET_FILM_SHARE * film, smoothImage, puddle);
#else
    vec3 reflected = vec3(-towardsEye.xy, towardsEye.z);
    // Houses, and above them the sky.
    vec3 houses = (0.5 * (frame.groundIrradiance.rgb + frame.skyIrradiance.rgb) + WET_HOUSES_SUN * frame.sunIrradiance.rgb) * (inversePi * WET_HOUSES_ALBEDO);
    vec3 mirrored = mix(houses, frame.skyIrradiance.rgb * inversePi, smoothstep(WET_SKY_FROM, WET_SKY_TO, reflected.z));
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
