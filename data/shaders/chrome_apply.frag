#version 450 core
// A piece of chrome takes what its layer holds, blended over the environment map's reflection that is there already.
layout(binding = 11) uniform sampler2D chromeLayer;
uniform vec3 reflectance;
uniform vec3 tint;
layout(location = 0) out vec4 colourOut;

void main() {
    vec4 seen = texelFetch(chromeLayer, ivec2(gl_FragCoord.xy), 0);
    if (seen.a == 0.0) discard;
    colourOut = vec4(tint * (1.0 - reflectance) + reflectance * seen.rgb, seen.a);
}
