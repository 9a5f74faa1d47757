// What all drawing of one view shares. Filled from app/render/FrameUniforms.h.
layout(std140, binding = 0) uniform Frame {
    mat4 clipFromRelative;     // relative: world axes, origin at the eye
    mat4 shadowFromWorld;      // static shadow map: xy texture coordinates, z depth
    vec4 eyeHigh;              // the eye in two floats, so that far from the origin no precision is lost; w: fading, 1 / metre
    vec4 eyeLow;               // w: cube face that is drawn
    vec4 sunDirection;         // xyz; w: turbidity
    vec4 sunIrradiance;        // rgb; w: exposure
    vec4 skyIrradiance;        // rgb; w: 1 when lamps are lit
    vec4 groundIrradiance;     // rgb; w: metres along the normal by which shadow lookups start
    vec4 fadeFrom;             // plane relative to the eye from which on what is seen fades: the glass that it is seen in
} frame;

const float inversePi = 0.31830989;

vec3 relativeFromWorld(vec3 world) { return (world - frame.eyeHigh.xyz) - frame.eyeLow.xyz; }

// Light from sky and ground on a surface by its normal alone; open in [0, 1] is the share of the sky that is not built up.
vec3 ambientIrradiance(vec3 normal, float open) {
    return mix(frame.groundIrradiance.rgb, frame.skyIrradiance.rgb, 0.5 + 0.5 * normal.z) * open;
}
