#version 450 core
// Panes of shop windows and curtain walls: what lies behind them is the picture on the wall, in dim light.
#include "frame.glsl"
#include "shadow.glsl"

struct MaterialEntry {
    vec4 tint;      // rgb albedo; w: layer of the pattern array
    vec4 emission;  // rgb
};
layout(std140, binding = 1) uniform Materials { MaterialEntry materials[1024]; };

layout(location = 0) in vec3 position;
layout(location = 1) in vec2 texcoord;
layout(location = 2) in vec4 normal;
layout(location = 3) in uint material;
layout(location = 4) in vec2 glass;  // reflectance, transmittance at normal incidence
layout(location = 5) in vec2 stuff;  // angle of gloss, radians; 1: what is painted lies at the surface, in the light of the street

layout(location = 0) out vec2 texcoordOut;
layout(location = 1) flat out float layerOut;
layout(location = 2) out vec3 shadedOut;  // tint times everything but the sun
layout(location = 3) out vec3 sunlitOut;  // tint times the sun
layout(location = 4) out vec3 shadowOut;
layout(location = 5) out vec3 relativeOut;
layout(location = 6) flat out vec3 normalOut;
layout(location = 7) flat out vec2 glassOut;
layout(location = 8) flat out float glossOut;

// Shares of the light outside that fall on what stands behind a window: twins in app/frame/GlassShading.h.
const float roomSky = 0.6;
const float roomSun = 0.35;

void main() {
    vec3 relative = relativeFromWorld(position);
    gl_Position = frame.clipFromRelative * vec4(relative, 1.0);
    MaterialEntry m = materials[material];
    texcoordOut = texcoord;
    layerOut = m.tint.w;
    vec3 albedo = m.tint.rgb * inversePi;
    shadedOut = albedo * ambientIrradiance(normal.xyz, mix(roomSky, 1.0, stuff.y)) + m.emission.rgb * frame.skyIrradiance.w;
    sunlitOut = albedo * frame.sunIrradiance.rgb * (mix(roomSun, 1.0, stuff.y) * max(dot(normal.xyz, frame.sunDirection.xyz), 0.0));
    shadowOut = shadowCoordinate(position, normal.xyz);
    relativeOut = relative;
    normalOut = normal.xyz;
    glassOut = glass;
    glossOut = stuff.x;
}
