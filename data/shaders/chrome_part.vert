#version 450 core
// A piece of chrome itself, in the frame of its reflector.
layout(location = 0) in vec3 position;
uniform mat4 clipFromPart;

void main() { gl_Position = clipFromPart * vec4(position, 1.0); }
