#version 450 core
#ifdef LAYERED
#extension GL_ARB_shader_viewport_layer_array : require
uniform int layer;
#endif
// One triangle over the whole target, infinitely far.
layout(location = 0) out vec2 ndcOut;
void main() {
    ndcOut = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
    gl_Position = vec4(ndcOut, 0.0, 1.0);
#ifdef LAYERED
    gl_Layer = layer;
#endif
}
