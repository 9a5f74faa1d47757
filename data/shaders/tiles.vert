#version 450 core
// Rectangles of a picture: one an instance, pixels x0 y0 x1 y1.
layout(location = 0) in ivec4 rectangle;
uniform vec2 size;  // of the picture
void main() {
    vec2 corner = vec2((gl_VertexID & 1) != 0 ? rectangle.z : rectangle.x, (gl_VertexID & 2) != 0 ? rectangle.w : rectangle.y);
    gl_Position = vec4(2.0 * corner / size - 1.0, 0.0, 1.0);
}
