#version 450 core
#include "frame.glsl"
#include "output.glsl"
layout(location = 0) in vec2 position;
layout(location = 1) flat in vec3 colour;
#ifdef CUBE
layout(location = 2) in vec3 relative;
#endif
void main() {
    if (dot(position, position) > 1.0) discard;
#ifdef CUBE
    writePixel(colour, relative);
#else
    writePixel(colour);
#endif
}
