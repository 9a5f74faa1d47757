#version 450 core
// Virtual objects of a piece of chrome: where the eye sees them in it, as far away as the light's whole path is long.
// WITH_STATUS: all triangles are drawn, and what lies behind the piece is left out here.
layout(location = 0) in vec3 fromEye;  // in the reflector's frame
layout(location = 1) in vec3 colour;
uniform mat4 clipFromVirtual;
layout(location = 0) out vec3 colourOut;
#ifdef WITH_STATUS
layout(location = 2) in uint status;  // ReflectionStatus
layout(location = 1) out vec2 seen;  // 0 where hidden; 0 where there is an answer
#endif

void main() {
    gl_Position = clipFromVirtual * vec4(fromEye, 1.0);
    colourOut = colour;
#ifdef WITH_STATUS
    seen = vec2(status != 1u, status > 2u);
#endif
}
