// Where shaded pixels go: a view takes display colours, a cube linear radiance and the distance from its centre.
#ifdef CUBE
layout(location = 0) out vec4 radianceOut;
layout(location = 1) out float distanceOut;
void writePixel(vec3 radiance, vec3 relative) {
    radianceOut = vec4(radiance, 1.0);
    distanceOut = length(relative);
}
#else
#include "tonemap.glsl"
layout(location = 0) out vec4 colourOut;
void writePixel(vec3 radiance) { colourOut = vec4(toneMap(radiance), 1.0); }
#endif
