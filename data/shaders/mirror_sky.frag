#version 450 core
// The background of a small scene, linear in the direction's height: the twin of MirrorWorld::sky.
layout(location = 0) in vec2 ndc;
layout(location = 0) out vec4 colourOut;
layout(location = 1) out float distanceOut;
uniform mat3 relativeFromView;
uniform vec4 projection;  // x, y: ndc for one unit of x / -z; z, w: offsets
uniform vec3 zenith, horizon, nadir;

void main() {
#ifdef PARABOLOID
    float r = dot(ndc, ndc);
    float z = (r - 1.0) / (r + 1.0);
    vec3 v = vec3(ndc * (1.0 - z), z);
#else
    vec3 v = vec3((ndc + projection.zw) / projection.xy, -1.0);
#endif
#ifdef NEARNESS
    const float alpha = 0.0;  // infinitely far: see mirror_world.frag
#else
    const float alpha = 1.0;
#endif
    float height = normalize(relativeFromView * v).z;
    colourOut = vec4(height >= 0.0 ? mix(horizon, zenith, height) : mix(horizon, nadir, -height), alpha);
    distanceOut = 1.0 / 0.0;
}
