#version 450 core
// Where panes will look an image up: as far away as can be.
layout(location = 0) in vec2 position;  // normalised device coordinates

void main() { gl_Position = vec4(position, 0.0, 1.0); }
