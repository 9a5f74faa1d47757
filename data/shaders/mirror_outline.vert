#version 450 core
// What a mirror shows of its map, infinitely far.
layout(location = 0) in vec2 ndc;  // of the whole image
uniform vec4 scaleOffset;          // to its crop: scale xy, offset zw
void main() { gl_Position = vec4(ndc * scaleOffset.xy + scaleOffset.zw, 0.0, 1.0); }
