#version 450 core
// The ground under and beside a vehicle, where its shadow may fall: one rectangle a vehicle.
#include "frame.glsl"
#include "shadow.glsl"
layout(location = 0) in vec4 place;    // xyz: middle of the vehicle's outline on the ground, relative to the eye; w: cosine of heading
layout(location = 1) in vec4 outline;  // x: sine of heading; y, z: half length and width; w: height
layout(location = 0) out vec2 positionOut;        // vehicle axes, metres from the middle
layout(location = 1) flat out vec4 outlineOut;    // half length, half width, height
layout(location = 2) out vec3 shadowOut;
layout(location = 3) flat out vec3 towardsSunOut;  // vehicle axes
void main() {
    float c = place.w;
    float s = outline.x;
    vec3 sun = frame.sunDirection.xyz;
    vec3 towardsSun = vec3(c * sun.x + s * sun.y, c * sun.y - s * sun.x, max(sun.z, 0.2));
    vec2 reach = -towardsSun.xy / towardsSun.z * outline.w;
    vec2 low = min(-outline.yz, -outline.yz + reach) - 0.6;
    vec2 high = max(outline.yz, outline.yz + reach) + 0.6;
    vec2 p = vec2((gl_VertexID & 1) != 0 ? high.x : low.x, (gl_VertexID & 2) != 0 ? high.y : low.y);
    vec3 relative = place.xyz + vec3(c * p.x - s * p.y, s * p.x + c * p.y, 0.02);
    positionOut = p;
    outlineOut = vec4(outline.yzw, 0.0);
    towardsSunOut = towardsSun;
    shadowOut = shadowCoordinate(relative + frame.eyeHigh.xyz + frame.eyeLow.xyz, vec3(0.0, 0.0, 1.0));
    // Pulled towards the eye along the line of sight: lies over road markings and low kerbs without moving on screen.
    gl_Position = frame.clipFromRelative * vec4(relative * (1.0 - 0.06 / max(length(relative), 1.0)), 1.0);
}
