#version 450 core
// A piece of chrome seen in another: its environment map where its rays end, and over it the picture of what is close to it
// (reflection/chrome/ChromeTree.h).
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 from;
layout(location = 3) in vec3 at;
layout(location = 0) out vec4 colourOut;
layout(binding = 8) uniform samplerCube map;
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
