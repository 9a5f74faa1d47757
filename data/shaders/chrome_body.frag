#version 450 core
// A piece of chrome seen in another: its environment map where its rays end, and over it the picture of what is close to it
// (reflection/chrome/ChromeTree.h). CLOSE: that picture alone, and its share over what the map shows; its part's pixels alone hold
// something.
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 from;
layout(location = 3) in vec3 at;
layout(location = 0) out vec4 colourOut;
#ifndef CLOSE
layout(binding = 8) uniform samplerCube map;
#endif
layout(binding = 12) uniform sampler2D picture;
uniform vec3 mapCentre;
uniform bool parallax;
uniform vec3 reflectance;
uniform vec3 tint;
uniform bool pictured;
uniform vec2 pictureShare;  // of the texture, in use
uniform mat4 pictureFromRelative;
uniform vec3 slice;  // axis; the picture is for places between these two
uniform vec2 sliceEnds;

#ifdef CLOSE
uniform float share;  // over what its map shows

vec4 pictureAt(vec2 uv) {
    // Between texels, by what they hold.
    vec2 place = uv * vec2(textureSize(picture, 0)) - 0.5;
    ivec2 low = ivec2(floor(place)), most = ivec2(pictureShare * vec2(textureSize(picture, 0)) + 0.5) - 1;
    vec2 part = place - vec2(low);
    vec4 sum = vec4(0.0);
    for (int k = 0; k < 4; ++k) {
        ivec2 offset = ivec2(k & 1, k >> 1);
        vec2 w = mix(1.0 - part, part, vec2(offset));
        vec4 texel = texelFetch(picture, clamp(low + offset, ivec2(0), most), 0);
        sum += w.x * w.y * vec4(texel.rgb * texel.a, texel.a);
    }
    return sum.a > 0.0 ? vec4(sum.rgb / sum.a, sum.a) : vec4(0.0);
}

void main() {
    vec3 n = normalize(normal), d = normalize(position - from);
    float along = dot(slice, position);
    if (dot(d, n) >= 0.0 || along < sliceEnds.x || along >= sliceEnds.y) discard;
    vec4 clip = pictureFromRelative * vec4(at, 1.0);
    colourOut = pictureAt(clamp(0.5 + 0.5 * clip.xy / clip.w, vec2(0.0), vec2(1.0)) * pictureShare);
    colourOut.a *= share;
}
#else
float nearnessAlong(vec3 direction) {
    vec3 a = abs(direction);
    return max(max(a.x, a.y), a.z) * textureLod(map, direction, 0.0).a;
}

// As in mirror_world.frag.
vec3 seenFromCentre(vec3 start, vec3 towards) {
    float first = nearnessAlong(towards);
    float second = nearnessAlong(towards + first * start);
    return towards + first / max(2.0 - second / max(first, 1e-6), 0.25) * start;
}

void main() {
    vec3 n = normalize(normal), d = normalize(position - from);
    float along = dot(slice, position);
    if (dot(d, n) >= 0.0 || along < sliceEnds.x || along >= sliceEnds.y) discard;
    vec3 r = reflect(d, n);
    vec3 light = textureLod(map, parallax ? seenFromCentre(position - mapCentre, r) : r, 0.0).rgb;
    if (pictured) {
        vec4 clip = pictureFromRelative * vec4(at, 1.0);
        // Past its ends the picture is as at them.
        vec2 uv = clamp(0.5 + 0.5 * clip.xy / clip.w, vec2(0.0), vec2(1.0)) * pictureShare;
        vec4 seen = textureLod(picture, min(uv, pictureShare - 0.5 / vec2(textureSize(picture, 0))), 0.0);
        light = seen.rgb + (1.0 - seen.a) * light;
    }
    colourOut = vec4(tint * (1.0 - reflectance) + reflectance * light, 1.0);
}
#endif
