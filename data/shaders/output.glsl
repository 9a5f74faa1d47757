// Where shaded pixels go: a view takes display colours, a cube linear radiance and the distance from its centre.
#if defined VIRTUAL
// What a piece of chrome shows of things close to it: linear radiance, and how much of it covers the local map's.
uniform vec4 closeAround;  // the piece's middle, relative to the eye; w: metres from there on which the map shows all
layout(location = 0) out vec4 radianceOut;
void writePixel(vec3 radiance, vec3 relative) {
    radianceOut = vec4(radiance, 1.0 - smoothstep(0.6, 1.0, distance(relative, closeAround.xyz) / closeAround.w));
}
#elif defined CUBE
layout(location = 0) out vec4 radianceOut;
layout(location = 1) out float distanceOut;
// What the way behind a mirror leaves; beyond a mirror on it, that mirror's own image has seen to it. The sky is infinitely far.
float leftOfLight(vec3 relative) {
    float way = length(relative);
    if (isinf(way)) return 0.0;
    float before = max(-frame.fadeFrom.w, 0.0) / max(dot(frame.fadeFrom.xyz, relative) / way, 1e-6);
    return exp(-frame.eyeHigh.w * max(way - before, 0.0));
}
void writePixel(vec3 radiance, vec3 relative) {
    if (frame.eyeHigh.w > 0.0) radiance *= leftOfLight(relative);
    radianceOut = vec4(radiance, 1.0);
    distanceOut = length(relative);
}
#else
#include "tonemap.glsl"
layout(location = 0) out vec4 colourOut;
void writePixel(vec3 radiance) { colourOut = vec4(toneMap(radiance), 1.0); }
#endif
