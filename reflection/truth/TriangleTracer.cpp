#include "reflection/truth/TriangleTracer.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace reflection {

struct TriangleTracer::Impl {
    RTCDevice device = nullptr;
    RTCScene scene = nullptr;
};

TriangleTracer::TriangleTracer() : impl_(std::make_unique<Impl>()) {
    impl_->device = rtcNewDevice(nullptr);
    if (!impl_->device)
        throw std::runtime_error("Embree could not start: this processor lacks SSE2 or memory ran out");
    impl_->scene = rtcNewScene(impl_->device);
    rtcSetSceneFlags(impl_->scene, RTC_SCENE_FLAG_ROBUST);
}

TriangleTracer::~TriangleTracer() {
    rtcReleaseScene(impl_->scene);
    rtcReleaseDevice(impl_->device);
}

void TriangleTracer::add(const city::Mesh& mesh, const glm::mat4& worldFromMesh) {
    if (mesh.empty()) return;
    RTCGeometry geometry = rtcNewGeometry(impl_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* positions = static_cast<float*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.vertices.size()));
    for (const city::Vertex& v : mesh.vertices) {
        const glm::vec3 p(worldFromMesh * glm::vec4(v.position, 1));
        *positions++ = p.x;
        *positions++ = p.y;
        *positions++ = p.z;
    }
    auto* indices = static_cast<std::uint32_t*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                3 * sizeof(std::uint32_t), mesh.triangleCount()));
    std::copy_n(mesh.indices.begin(), 3 * mesh.triangleCount(), indices);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(impl_->scene, geometry);
    rtcReleaseGeometry(geometry);
}

void TriangleTracer::commit() {
    rtcCommitScene(impl_->scene);
}

void TriangleTracer::traceFan(const glm::vec3& origin, std::span<const float> dx, std::span<const float> dy,
                              std::span<const float> dz, std::span<float> t) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    constexpr std::size_t width = 16;
    for (std::size_t first = 0; first < t.size(); first += width) {
        alignas(64) RTCRayHit16 rays;
        alignas(64) int valid[width];
        const std::size_t count = std::min(width, t.size() - first);
        for (std::size_t i = 0; i < width; ++i) {
            valid[i] = i < count ? -1 : 0;
            const std::size_t k = first + std::min(i, count - 1);
            rays.ray.org_x[i] = origin.x;
            rays.ray.org_y[i] = origin.y;
            rays.ray.org_z[i] = origin.z;
            rays.ray.dir_x[i] = dx[k];
            rays.ray.dir_y[i] = dy[k];
            rays.ray.dir_z[i] = dz[k];
            rays.ray.tnear[i] = 0;
            rays.ray.tfar[i] = std::numeric_limits<float>::infinity();
            rays.ray.mask[i] = 0xffffffffu;
            rays.ray.time[i] = 0;
            rays.ray.id[i] = 0;
            rays.ray.flags[i] = 0;
            rays.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
            rays.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
        }
        rtcIntersect16(valid, impl_->scene, &context, &rays);
        for (std::size_t i = 0; i < count; ++i)
            t[first + i] = rays.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID
                               ? std::numeric_limits<float>::infinity()
                               : rays.ray.tfar[i];
    }
}

}  // namespace reflection
