/// One face of a local map to build (C++: LocalMapPass.cpp).
struct FaceJob {
    uint start;  // first of its reciprocals
    int face;    // 0 .. 5
    int layer;   // of the cube map array: 6 * cube + face
    int lookups;
    uint firstView;  // candidates: so many of mapViews from here
    uint viewCount;
    float agreement;
    uint overlay;      // first of its overlay's texels
    ivec4 overlayBox;  // where moving objects were drawn: first texel, texel behind the last; equal: nowhere
    uint sky;          // first of its sky's texels; all bits: the reference maps have the sky
};
layout(std430, binding = 2) readonly restrict buffer FaceJobs { FaceJob faceJobs[]; };

/// Mean colour of each group of 8 x 8 texels, row by row, face by face.
layout(std430, binding = 5) restrict buffer Means { vec4 means[]; };

// The dispatch's share of both.
uniform int firstJob;
uniform int firstMean;
uniform int faceSize;
