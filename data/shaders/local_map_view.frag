#version 450 core
// A local map unfolded: four faces round the horizon, up above and down below north. Twin of the table in
// app/panel/MapView.cpp.
uniform samplerCubeArray maps;
uniform int layer;
uniform float exposure;
uniform vec2 faces;
uniform vec2 pictureSize;
out vec4 colour;

void main() {
    // From the top left, in faces.
    vec2 at = vec2(gl_FragCoord.x, pictureSize.y - gl_FragCoord.y) / pictureSize * faces;
    ivec2 cell = ivec2(floor(at));
    vec2 p = vec2(2.0, -2.0) * (fract(at) - 0.5);
    vec3 direction;
    if (cell.y == 1) {
        vec3 forward = cell.x == 0 ? vec3(-1, 0, 0) : cell.x == 1 ? vec3(0, 1, 0) : cell.x == 2 ? vec3(1, 0, 0) : vec3(0, -1, 0);
        direction = forward + p.x * cross(forward, vec3(0, 0, 1)) + p.y * vec3(0, 0, 1);
    } else if (cell.x == 1) {
        direction = cell.y == 0 ? vec3(p.x, -p.y, 1.0) : vec3(p.x, p.y, -1.0);
    } else {
        colour = vec4(0.06, 0.06, 0.07, 1.0);
        return;
    }
    // The curve of tonemap.glsl.
    vec3 x = max(textureLod(maps, vec4(direction, float(layer)), 0.0).rgb * (1.4 * exposure) - 0.004, 0.0);
    colour = vec4((x * (6.2 * x + 0.5)) / (x * (6.2 * x + 1.7) + 0.06), 1.0);
}
