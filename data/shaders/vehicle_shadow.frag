#version 450 core
// How much of its light the ground keeps beside a vehicle, as a factor on display colours or (LINEAR) on radiance.
#include "frame.glsl"
layout(binding = 1) uniform sampler2DShadow sunShadow;
layout(location = 0) in vec2 position;
layout(location = 1) flat in vec4 outline;
layout(location = 2) in vec3 shadowCoordinateIn;
layout(location = 3) flat in vec3 towardsSun;
layout(location = 0) out vec4 factorOut;

float outside(vec2 p, vec2 halfSize) {  // metres from a rectangle, negative within
    vec2 d = abs(p) - halfSize;
    return length(max(d, 0.0)) + min(max(d.x, d.y), 0.0);
}

// Whether the ray from p towards the sun meets a box standing from z0 to z1: how deep its midst passes within the outline, soft at the edge.
float covered(vec2 p, vec2 halfSize, float z0, float z1, float blur) {
    vec2 perMetre = towardsSun.xy / towardsSun.z;
    vec2 a = p + perMetre * z0;
    vec2 step = perMetre * (z1 - z0);
    // The nearest the segment comes to the rectangle, at three points: outlines are longer than these are apart.
    float d = min(min(outside(a, halfSize), outside(a + 0.5 * step, halfSize)), outside(a + step, halfSize));
    return 1.0 - smoothstep(-blur, blur, d);
}

void main() {
    vec2 halfSize = outline.xy;
    float height = outline.z;
    // The sky is hidden under the floor and, less and less, beside it.
    float open = 1.0 - 0.82 * (1.0 - smoothstep(-0.35, 0.45, outside(position, halfSize - 0.08)));
    float shade = max(covered(position, halfSize - vec2(0.1, 0.06), 0.2, 0.6 * height, 0.06),
                      covered(position, halfSize * vec2(0.62, 0.84), 0.6 * height, 0.97 * height, 0.12));
    float sun = texture(sunShadow, shadowCoordinateIn);
    vec3 direct = frame.sunIrradiance.rgb * max(frame.sunDirection.z, 0.0) * sun;
    vec3 before = frame.skyIrradiance.rgb + direct;
    vec3 after = frame.skyIrradiance.rgb * open + direct * (1.0 - shade) * min(1.0, 0.4 + open);
#ifdef LINEAR
    factorOut = vec4(after / before, 1.0);
#else
    factorOut = vec4(sqrt(after / before), 1.0);  // display values are about square roots of radiance
#endif
}
