#version 450 core
// Depth alone; what is cut out leaves holes.
#ifdef CUTOUT
layout(binding = 0) uniform sampler2DArray patterns;
layout(location = 0) in vec2 texcoord;
layout(location = 1) flat in float layer;
#endif
void main() {
#ifdef CUTOUT
    if (texture(patterns, vec3(texcoord, layer)).a < 0.5) discard;
#endif
}
