#version 450 core
// Virtual objects that are lit already.
layout(location = 0) in vec3 colour;
layout(location = 0) out vec4 colourOut;
#ifdef WITH_STATUS
layout(location = 1) in vec2 seen;
#endif

void main() {
#ifdef WITH_STATUS
    // Between hidden vertices only, or at one without an answer.
    if (seen.x <= 0.0 || seen.y > 0.0) discard;
#endif
    colourOut = vec4(colour, 1.0);
}
