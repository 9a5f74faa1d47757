#version 450 core
// MATTE: what the corners say. FLAT: a planar mirror with its map, DISTANCE: with distances, ROUGH: blurred here, GLOSSED: blurred already, BUMPED: with waves. Otherwise a curved
// reflector: VIEW: view-dependent map, CUBE or PAIR: view-independent, PARALLAX: with distances in alpha, ROUGH: blurred. FADED: in an image that mirrors
// on the way to the eye fade by distance. NEARNESS: alpha is 1 / depth along the greatest axis, for parallax in environment maps.
#if defined(FLAT) || (defined(VIEW) && defined(ROUGH))
#include "mirror_map.glsl"
#endif
layout(location = 0) in vec3 relative;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 colour;
layout(location = 0) out vec4 colourOut;
layout(location = 1) out float distanceOut;
uniform vec3 reflectance;
uniform vec3 tint;
#if defined(FLAT)
uniform vec3 mirrorNormal;
uniform mat3 viewFromRelative;  // of the image in which the mirror is met
uniform vec2 uvPerTangent;      // texture coordinates for one unit of x / -z in view space
uniform float glossAngle;       // radians
uniform int blurLevels;
#ifdef DISTANCE
layout(binding = 10) uniform sampler2D mirrorDistance;
uniform bool addDistance;
#endif
#elif defined(VIEW)
layout(binding = 8) uniform sampler2D map;
uniform mat3 mapFromRelative;  // view space of the map
uniform float mapScale;        // ndc for one unit of x / -z
uniform vec4 mapPart;          // of the texture in use: size, low corner
uniform vec4 mapLimits;        // middles of its outermost texels
#ifdef ROUGH
uniform float glossAngle;  // radians
uniform int blurLevels;
#endif
#elif defined(CUBE)
layout(binding = 8) uniform samplerCube map;
vec4 mapTowards(vec3 direction) { return textureLod(map, direction, 0.0); }
vec3 mapAtLevel(vec3 direction, float level) { return textureLod(map, direction, level).rgb; }
#elif defined(PAIR)
layout(binding = 8) uniform sampler2DArray map;
// Halves look along +z and -z: see paraboloidView.
vec4 mapTowards(vec3 direction) {
    vec3 r = normalize(direction);
    bool up = r.z >= 0.0;
    vec3 q = up ? vec3(r.x, -r.y, -r.z) : r;
    return textureLod(map, vec3(0.5 + 0.5 * q.xy / (1.0 - q.z), up ? 0.0 : 1.0), 0.0);
}
vec3 mapAtLevel(vec3 direction, float level) {
    vec3 r = normalize(direction);
    bool up = r.z >= 0.0;
    vec3 q = up ? vec3(r.x, -r.y, -r.z) : r;
    return textureLod(map, vec3(0.5 + 0.5 * q.xy / (1.0 - q.z), up ? 0.0 : 1.0), level).rgb;
}
#endif

#if (defined(CUBE) || defined(PAIR)) && defined(ROUGH)
uniform float glossAngle;  // radians; see reflection/planar/Gloss.h
// Light under a Gaussian about a direction, `along` and `across`: directions by one deviation each. Half of the variance is the mip
// level's (a quarter of a texel's square), half that of nine lookups with the weights of Gauss and Hermite: no texel shows.
vec3 mapBlurred(vec3 direction, vec3 along, vec3 across) {
    float wide = length(along), narrow = max(length(across), 0.5 * wide);
    float texel = 2.0 / float(textureSize(map, 0).x);
    float level = max(log2(1.4142136 * narrow / texel), 0.0);
    vec3 sum = vec3(0.0);
    along *= sqrt(max(1.0 - 0.5 * narrow * narrow / (wide * wide), 0.0)) * 1.7320508;
    across *= 0.7071068 * 1.7320508;
    for (int i = -1; i <= 1; ++i)
        for (int j = -1; j <= 1; ++j) {
            float weight = (i == 0 ? 4.0 : 1.0) * (j == 0 ? 4.0 : 1.0) / 36.0;
            sum += weight * mapAtLevel(direction + float(i) * along + float(j) * across, level);
        }
    return sum;
}
#endif

float greatest(vec3 v) {
    vec3 a = abs(v);
    return max(max(a.x, a.y), a.z);
}

#ifdef PARALLAX
uniform vec3 mapCentre;  // relative to the eye
float nearnessAlong(vec3 direction) { return greatest(direction) * mapTowards(direction).a; }

// Where the map's centre sees what a ray from off the centre meets: as vehicle.frag does, by one secant, which is exact on planes.
vec3 seenFromCentre(vec3 from, vec3 towards) {
    float first = nearnessAlong(towards);
    float second = nearnessAlong(towards + first * from);
    return towards + first / max(2.0 - second / max(first, 1e-6), 0.25) * from;
}
#endif

#ifdef BUMPED
uniform vec3 eye;
uniform vec3 rippleU, rippleV;
uniform vec2 ripples;  // slope, wavelength

// The twin of app::rippleSlope.
vec2 rippleSlope(vec3 world) {
    vec2 at = vec2(dot(rippleU, world), dot(rippleV, world)), slope = vec2(0.0);
    float number = 6.28318531 / ripples.y;
    for (int i = 0; i < 6; ++i) {
        float angle = 0.43633231 * (float(i) - 2.5) * (i % 2 == 0 ? 1.0 : -1.0);
        vec2 along = vec2(cos(angle), sin(angle));
        slope += ripples.x * sqrt(2.0 / 6.0) * cos(number * dot(along, at) + 2.4 * float(i)) * along;
        number /= 0.7;
    }
    return slope;
}

// Texture coordinates at which the map shows what a direction, or a place relative to the eye, leads to.
vec2 uvTowards(vec3 place) {
    vec3 q = viewFromRelative * place, here = viewFromRelative * relative;
    return mirrorUv(gl_FragCoord.xy) + (q.xy / max(-q.z, 1e-4) - here.xy / -here.z) * uvPerTangent;
}

vec3 mirrorBumped(vec3 d) {
    vec2 slope = rippleSlope(relative + eye);
    vec3 r = reflect(d, normalize(mirrorNormal - slope.x * rippleU - slope.y * rippleV));
    float up = dot(r, mirrorNormal);
    if (up <= 1e-3) return mirrorSharp(gl_FragCoord.xy, vec2(0.0));
    // Behind the glass the ray goes on as if mirrored; the map tells where it ends.
    vec3 v = r - 2.0 * up * mirrorNormal;
    float before = length(relative), behind = textureLod(mirrorDistance, mirrorUv(gl_FragCoord.xy), 0.0).r - before;
    vec2 uv = mirrorUv(gl_FragCoord.xy);
    for (int step = 0; step < 3; ++step) {
        vec3 place = isinf(behind) ? v : relative + max(behind, 0.0) * v;
        uv = clamp(uvTowards(place), uvLimits.xy, uvLimits.zw);
        float way = textureLod(mirrorDistance, uv, 0.0).r;
        behind = isinf(way) ? way : dot(way * normalize(place) - relative, v);
    }
    return textureLod(mirrorColour, uv, 0.0).rgb;
}
#endif

#ifdef FADED
uniform float fading;   // 1 / metre
uniform vec4 fadeFrom;  // the mirror that the eye looks through: w < 0; else it fades from the eye on
// What the way behind the glass leaves; beyond a mirror on it, that mirror's own image has seen to it.
float leftOfLight() {
    float way = length(relative);
    float before = max(-fadeFrom.w, 0.0) / max(dot(fadeFrom.xyz, relative) / way, 1e-6);
    return exp(-fading * max(way - before, 0.0));
}
#endif

void main() {
    distanceOut = length(relative);
#ifdef NEARNESS
    float alpha = 1.0 / max(greatest(relative), 1e-6);
#else
    float alpha = 1.0;
#endif
#if defined(MATTE)
    colourOut = vec4(colour, alpha);
#else
    vec3 d = normalize(relative);
    vec3 light;
#if defined(FLAT)
#ifdef ROUGH
    vec3 along, across;
    mirrorSpread(d, mirrorNormal, glossAngle, along, across);
    vec3 v = viewFromRelative * d;
    light = mirrorGloss(gl_FragCoord.xy, vec2(0.0), mirrorMovement(v, viewFromRelative * along, uvPerTangent),
                        mirrorMovement(v, viewFromRelative * across, uvPerTangent), blurLevels);
#elif defined(GLOSSED)
    light = textureLod(mirrorBlurred, mirrorUv(gl_FragCoord.xy) * blurredScale, 0.0).rgb;
#elif defined(BUMPED)
    light = mirrorBumped(d);
#else
    light = textureLod(mirrorColour, mirrorUv(gl_FragCoord.xy), 0.0).rgb;
#endif
#ifdef DISTANCE
    float way = textureLod(mirrorDistance, mirrorUv(gl_FragCoord.xy), 0.0).r;
    if (addDistance) distanceOut = way;
#ifdef NEARNESS
    alpha = 1.0 / max(way * greatest(d), 1e-6);
#endif
#endif
#else
    vec3 r = reflect(d, normalize(normal));
#if defined(VIEW)
    vec3 q = mapFromRelative * r;
    // Directions beyond the map's field of view take its border's colour.
    vec2 at = q.z < -1e-4 ? q.xy / -q.z * mapScale : normalize(q.xy + vec2(1e-9)) * 2.0;
    at *= min(1.0, 1.0 / max(length(at), 1e-9));
    vec2 uv = clamp((0.5 + 0.5 * at) * mapPart.xy + mapPart.zw, mapLimits.xy, mapLimits.zw);
#ifdef ROUGH
    // The spread about the reflected direction, at the place of the map that stands for it.
    vec3 n = normalize(normal), along, across;
    mirrorSpread(d, n, glossAngle, along, across);
    vec3 v = vec3(at, -mapScale);
    vec2 uvPerTangent = 0.5 * mapScale * mapPart.xy * blurredScale;
    float unit = 1.0 / length(v);
    light = mirrorGlossAt(uv * blurredScale, mapLimits * blurredScale.xyxy, mirrorMovement(v * unit, mapFromRelative * reflect(along, n), uvPerTangent),
                          mirrorMovement(v * unit, mapFromRelative * reflect(across, n), uvPerTangent), blurLevels);
#else
    light = textureLod(map, uv, 0.0).rgb;
#endif
#else
    vec3 seen = r;
#ifdef PARALLAX
    seen = seenFromCentre(relative - mapCentre, r);
#endif
#ifdef ROUGH
    {
        // `seen` is r and a share of the way from the centre: per radian about r what is met moves by its distance.
        float facing = clamp(-dot(d, normalize(normal)), 1e-3, 1.0), whole = length(seen);
        vec3 within = normalize(normal) + facing * d;
        float size = length(within);
        vec3 e1 = size > 1e-4 ? within / size : normalize(cross(d, abs(d.z) < 0.9 ? vec3(0, 0, 1) : vec3(1, 0, 0)));
        e1 = reflect(e1, normalize(normal));
        vec3 e2 = cross(r, e1), unit = seen / whole;
        light = mapBlurred(unit, glossAngle / whole * (e1 - dot(e1, unit) * unit), glossAngle * facing / whole * (e2 - dot(e2, unit) * unit));
    }
#else
    light = mapTowards(seen).rgb;
#endif
#endif
#endif
    colourOut = vec4(tint * (1.0 - reflectance) + reflectance * light, alpha);
#endif
#ifdef FADED
    colourOut.rgb *= leftOfLight();
#endif
}
