#version 450 core
// What a rough mirror shows, once for each texel of its map, for mirrors' shaders that look it up like a sharp one.
#include "mirror_map.glsl"  // in coordinates of mirrorBlurred: uvLimits too, blurredScale is 1
layout(location = 0) out vec4 glossedOut;
uniform vec3 rayBase, rayRight, rayUp;  // world direction of a fragment from the eye behind the glass: base + x * right + y * up
uniform vec3 glassNormal;               // of the mirror, away from that eye
uniform mat3 viewFromWorld;
uniform vec2 uvPerTangent;
uniform float glossAngle;
uniform int blurLevels;

void main() {
    vec3 d = normalize(rayBase + gl_FragCoord.x * rayRight + gl_FragCoord.y * rayUp);
    vec3 along, across;
    mirrorSpread(d, -glassNormal, glossAngle, along, across);
    vec3 v = viewFromWorld * d;
    glossedOut = vec4(mirrorGlossAt(gl_FragCoord.xy / vec2(textureSize(mirrorBlurred, 0)), uvLimits,
                                    mirrorMovement(v, viewFromWorld * along, uvPerTangent),
                                    mirrorMovement(v, viewFromWorld * across, uvPerTangent), blurLevels), 1.0);
}
