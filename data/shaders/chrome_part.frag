#version 450 core
// The pixels of a piece of chrome take what its layer holds; where that is nothing they still hide what is behind them.
layout(binding = 5) uniform sampler2D chromeLayer;
uniform float share;  // over the local map
layout(location = 0) out vec4 colourOut;

void main() {
    vec4 seen = texelFetch(chromeLayer, ivec2(gl_FragCoord.xy), 0);
    colourOut = vec4(seen.rgb, share * seen.a);
}
