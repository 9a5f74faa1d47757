// Looking up the sun's shadows. See app/render/ShadowMap.h.

// Receivers move along their normal, and a little towards the sun, so that no surface shades itself.
vec3 shadowCoordinate(vec3 world, vec3 normal) {
    return (frame.shadowFromWorld * vec4(world + normal * frame.groundIrradiance.w, 1.0)).xyz;
}
