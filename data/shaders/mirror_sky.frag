#version 450 core
// The background of a small scene, linear in the direction's height: the twin of MirrorWorld::sky.
layout(location = 0) out vec4 colourOut;
layout(location = 1) out float distanceOut;
uniform vec3 zenith, horizon, nadir;
#ifdef PARABOLOID
layout(location = 0) in vec2 ndc;
uniform mat3 relativeFromView;
#else
layout(location = 0) in vec3 ray;
#endif

void main() {
#ifdef PARABOLOID
    float r = dot(ndc, ndc);
    float z = (r - 1.0) / (r + 1.0);
    float height = normalize(relativeFromView * vec3(ndc * (1.0 - z), z)).z;
#else
    float height = ray.z * inversesqrt(dot(ray.xy, ray.xy) + 1.0);
#endif
#ifdef NEARNESS
    const float alpha = 0.0;  // infinitely far: see mirror_world.frag
#else
    const float alpha = 1.0;
#endif
    colourOut = vec4(horizon + abs(height) * ((height >= 0.0 ? zenith : nadir) - horizon), alpha);
    distanceOut = 1.0 / 0.0;
}
