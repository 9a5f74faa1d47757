// Where a ray that starts off a local map's centre ends, as the centre sees it.
layout(binding = 4) uniform samplerCubeArray nearness;  // 1 / distance along the cube's directions

/// 1 / distance, in units of the direction's length, of what the map's centre sees there.
float nearnessAlong(vec3 direction, float cube) {
    vec3 a = abs(direction);
    return max(max(a.x, a.y), a.z) * textureLod(nearness, vec4(direction, cube), 0.0).r;
}

/// 1 / distance of what a ray meets that starts off the map's centre, 0 for the sky: the root w of
/// nearnessAlong(towards + w * from) = w, since the centre sees from + towards / w there. On a plane nearness is
/// linear in the direction, and the secant through w = 0 and what the direction alone says ends at the root. More
/// lookups were measured to gain nothing: what is left is hidden from the centre.
float nearnessOfHit(vec3 from, vec3 towards, float cube) {
    float first = nearnessAlong(towards, cube);
    float second = nearnessAlong(towards + first * from, cube);
    // The quotient is 1 far away and near 2 where the centre sees past the ray's plane.
    return first / max(2.0 - second / max(first, 1e-6), 0.25);
}
