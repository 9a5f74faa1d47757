#version 450 core
// Copies from the corner of an image that was drawn, stretched over the whole of a picture of the image's size.
layout(binding = 3) uniform sampler2D image;
uniform vec2 size;   // of both
uniform vec2 drawn;  // pixels of the image
layout(location = 0) out vec4 colourOut;
void main() {
    colourOut = textureLod(image, clamp(gl_FragCoord.xy * drawn / size, vec2(0.5), drawn - 0.5) / size, 0.0);
}
