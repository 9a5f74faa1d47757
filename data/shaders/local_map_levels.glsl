// Writing local maps' texels and halving them within a work group of 8 x 8.

layout(local_size_x = 8, local_size_y = 8) in;

/// Four levels of a cube map array of R11F_G11F_B10F, seen as words: rounding is then ours (PackedMips.cpp), not
/// the implementation's.
layout(r32ui, binding = 0) writeonly restrict uniform uimageCubeArray level0;
layout(r32ui, binding = 1) writeonly restrict uniform uimageCubeArray level1;
layout(r32ui, binding = 2) writeonly restrict uniform uimageCubeArray level2;
layout(r32ui, binding = 3) writeonly restrict uniform uimageCubeArray level3;

/// PackedMips.cpp's toSmallFloat: 5 exponent bits and so many mantissa bits, rounded to nearest.
uint toSmallFloat(float value, uint mantissaBits) {
    uint dropped = 23u - mantissaBits;
    float greatest = (2.0 - 1.0 / float(1u << mantissaBits)) * 32768.0;
    if (!(value >= 1.0 / 16384.0)) return 0u;
    uint bits = floatBitsToUint(min(value, greatest)) + (1u << (dropped - 1u)) - (112u << 23);
    return min(bits >> dropped, (30u << mantissaBits) | ((1u << mantissaBits) - 1u));
}
uint packTexel(vec3 colour) {
    return toSmallFloat(colour.r, 6u) | (toSmallFloat(colour.g, 6u) << 11) | (toSmallFloat(colour.b, 5u) << 22);
}

shared vec3 tile[64];

/// The group's 8 x 8 texels to the next three levels of which it has texels: PackedMips.cpp's Halve. `corner`: the
/// group's first texel; `side`: of the group's part that is in use, a power of two. Returns, in the group's first
/// invocation, the mean of its part.
vec3 storeHalves(vec3 colour, ivec2 corner, int side, int layer) {
    ivec2 id = ivec2(gl_LocalInvocationID.xy);
    for (int level = 1; level <= 3; ++level) {
        tile[id.y * 8 + id.x] = colour;
        barrier();
        side >>= 1;
        corner >>= 1;
        if (id.x < side && id.y < side) {
            int from = 16 * id.y + 2 * id.x;
            colour = 0.25 * ((tile[from] + tile[from + 1]) + (tile[from + 8] + tile[from + 9]));
            ivec3 to = ivec3(corner + id, layer);
            uint texel = packTexel(colour);
            if (level == 1) imageStore(level1, to, uvec4(texel));
            if (level == 2) imageStore(level2, to, uvec4(texel));
            if (level == 3) imageStore(level3, to, uvec4(texel));
        }
        barrier();
    }
    return colour;
}
