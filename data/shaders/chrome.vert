#version 450 core
// Virtual objects of a piece of chrome: where the eye sees them in it, as far away as the light's whole path is long.
layout(location = 0) in vec3 fromEye;  // in the reflector's frame
layout(location = 1) in vec3 colour;
uniform mat4 clipFromVirtual;
layout(location = 0) out vec3 colourOut;

void main() {
    gl_Position = clipFromVirtual * vec4(fromEye, 1.0);
    colourOut = colour;
}
