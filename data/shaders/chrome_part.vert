#version 450 core
// A piece of chrome itself, in the frame of its reflector.
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
uniform mat4 clipFromPart;
uniform mat4 relativeFromPart;
layout(location = 0) out vec3 relativeOut;
layout(location = 1) out vec3 normalOut;

void main() {
    gl_Position = clipFromPart * vec4(position, 1.0);
    relativeOut = (relativeFromPart * vec4(position, 1.0)).xyz;
    normalOut = mat3(relativeFromPart) * normal;
}
