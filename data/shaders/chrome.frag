#version 450 core
// Virtual objects that are lit already.
layout(location = 0) in vec3 colour;
layout(location = 0) out vec4 colourOut;

void main() { colourOut = vec4(colour, 1.0); }
