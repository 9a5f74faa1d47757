// Vertices that are searched for, and what is found. ChromeSearch.h's GpuReflection.

/// Three floats each, relative to the map's centre, in the reflector's axes, metres.
layout(std430, binding = 3) readonly restrict buffer Vertices { float vertexFloats[]; };

struct Result {
    vec3 fromEye;    // VirtualVertex
    uint status;
    vec3 point;      // relative to the map's centre
    float residual;
    vec3 normal;
    float path;
};
layout(std430, binding = 4) writeonly restrict buffer Results { Result results[]; };

/// Vertices that a pass leaves to the next one; groups of the next dispatch come first, as indirect dispatches want
/// them.
struct LeftCount { uint groupsX, groupsY, groupsZ, count; };
layout(std430, binding = 5) restrict buffer LeftCounts { LeftCount left[2]; };
layout(std430, binding = 6) restrict buffer LeftVertices { uint leftVertex[]; };

/// In the reflector's axes; false where it is not finite.
bool vertexOf(uint index, out vec3 vertex) {
    vertex = vec3(vertexFloats[3u * index], vertexFloats[3u * index + 1u], vertexFloats[3u * index + 2u]);
    uvec3 exponent = floatBitsToUint(vertex) & 0x7f800000u;
    return all(notEqual(exponent, uvec3(0x7f800000u)));
}

real3 intoMap(vec3 vertex) {
    real3 p = real3(vertex);
    return real3(dot(p, real3(axisX.xyz)), dot(p, real3(axisY.xyz)), dot(p, real3(axisZ.xyz))) / real(axisX.w);
}
vec3 turnedOut(real3 d) {
    return vec3(d.x * real3(axisX.xyz) + d.y * real3(axisY.xyz) + d.z * real3(axisZ.xyz));
}

void writeResult(uint index, uint status, real3 eye, real3 vertex, real3 point, real3 normal, real residual, real path) {
    real scale = real(axisX.w);
    // Where the bisector is the normal, the mirrored vertex lies on the line of sight: this has fewer roundings.
    real3 image = point - eye;
    if (status == statusFound)
        image *= path / max(sqrt(dot(image, image)), tiny);
    else
        image = vertex - eye - real(2) * dot(vertex - point, normal) * normal;
    Result r;
    r.fromEye = turnedOut(scale * image);
    r.status = status;
    r.point = turnedOut(scale * point);
    r.residual = float(residual);
    r.normal = turnedOut(normal);
    r.path = float(scale * path);
    results[index] = r;
}

void writeInvalid(uint index) {
    results[index] = Result(vec3(0), statusInvalid, vec3(0), 0.0, vec3(0), 0.0);
}

real angleOf(real error) {
    return error <= real(1) ? real(asin(float(sqrt(error)))) : real(3.14159265);
}
