#version 450 core
#include "frame.glsl"
#include "sky.glsl"
#include "output.glsl"
layout(location = 0) in vec3 direction;
void main() {
    vec3 radiance = skyRadiance(normalize(direction));
#ifdef CUBE
    writePixel(radiance, vec3(uintBitsToFloat(0x7f800000u)));
#else
    writePixel(radiance);
#endif
}
