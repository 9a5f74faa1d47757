#include "reflection/truth/TracedScene.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace reflection {

namespace {

/// Rays of neighbouring pixels: packets of sixteen told to be coherent took two thirds of the time of eight
/// that were not, mirror rays included.
constexpr std::size_t packet = 16;
/// The filter of a query is heard only where the scene says so.
const RTCSceneFlags sceneFlags = RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION;

/// What the filters need to know of the rays: found by the ray's id, its place in the packet.
struct RayContext {
    RTCIntersectContext embree;
    const TracedRay* rays = nullptr;
};

struct PartData {
    const Holes* holes = nullptr;
    bool twoSided = false;
};

/// Called by Embree for each hit on a part with holes that would be kept.
void filterHoles(const RTCFilterFunctionNArguments* arguments) {
    const Holes* holes = static_cast<const PartData*>(arguments->geometryUserPtr)->holes;
    const auto* context = reinterpret_cast<const RayContext*>(arguments->context);
    const unsigned n = arguments->N;
    for (unsigned i = 0; i < n; ++i) {
        if (arguments->valid[i] != -1) continue;
        const TracedRay& ray = context->rays[RTCRayN_id(arguments->ray, n, i)];
        const float footprint = ray.width + ray.spread * RTCRayN_tfar(arguments->ray, n, i);
        if (holes->openAt(RTCHitN_primID(arguments->hit, n, i), RTCHitN_u(arguments->hit, n, i),
                          RTCHitN_v(arguments->hit, n, i), footprint))
            arguments->valid[i] = 0;
    }
}

/// Called by Embree for each hit that would be kept, in queries that pass backs.
void filterBacks(const RTCFilterFunctionNArguments* arguments) {
    if (static_cast<const PartData*>(arguments->geometryUserPtr)->twoSided) return;
    const unsigned n = arguments->N;
    for (unsigned i = 0; i < n; ++i) {
        if (arguments->valid[i] != -1) continue;
        // Both in the mesh's frame.
        const float along = RTCHitN_Ng_x(arguments->hit, n, i) * RTCRayN_dir_x(arguments->ray, n, i) +
                            RTCHitN_Ng_y(arguments->hit, n, i) * RTCRayN_dir_y(arguments->ray, n, i) +
                            RTCHitN_Ng_z(arguments->hit, n, i) * RTCRayN_dir_z(arguments->ray, n, i);
        if (along > 0) arguments->valid[i] = 0;
    }
}

template <class Packet>
void fill(Packet& rays, std::span<const TracedRay> from, int* valid) {
    for (std::size_t i = 0; i < packet; ++i) {
        valid[i] = i < from.size() ? -1 : 0;
        const TracedRay& r = from[std::min(i, from.size() - 1)];
        rays.org_x[i] = r.origin.x;
        rays.org_y[i] = r.origin.y;
        rays.org_z[i] = r.origin.z;
        rays.dir_x[i] = r.direction.x;
        rays.dir_y[i] = r.direction.y;
        rays.dir_z[i] = r.direction.z;
        rays.tnear[i] = r.from;
        rays.tfar[i] = r.to;
        rays.mask[i] = 0xffffffffu;
        rays.time[i] = 0;
        rays.id[i] = static_cast<unsigned>(i);
        rays.flags[i] = 0;
    }
}

}  // namespace

struct TracedMeshes::Impl {
    RTCDevice device = nullptr;
    std::vector<RTCScene> scenes;
    std::vector<std::unique_ptr<PartData>> parts;  ///< where Embree was told that they are
};

TracedMeshes::TracedMeshes() : impl_(std::make_unique<Impl>()) {
    impl_->device = rtcNewDevice(nullptr);
    if (!impl_->device)
        throw std::runtime_error("Embree could not start: this processor lacks SSE2 or memory ran out");
}

TracedMeshes::~TracedMeshes() {
    for (RTCScene scene : impl_->scenes) rtcReleaseScene(scene);
    rtcReleaseDevice(impl_->device);
}

std::uint32_t TracedMeshes::add(std::span<const Part> parts) {
    RTCScene scene = rtcNewScene(impl_->device);
    rtcSetSceneFlags(scene, sceneFlags);
    for (unsigned id = 0; id < parts.size(); ++id) {
        const city::Mesh& mesh = *parts[id].mesh;
        if (mesh.triangleCount() == 0) continue;
        RTCGeometry geometry = rtcNewGeometry(impl_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
        auto* positions = static_cast<float*>(rtcSetNewGeometryBuffer(
            geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.vertices.size()));
        for (const city::Vertex& v : mesh.vertices) {
            *positions++ = v.position.x;
            *positions++ = v.position.y;
            *positions++ = v.position.z;
        }
        auto* indices = static_cast<std::uint32_t*>(
            rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                    3 * sizeof(std::uint32_t), mesh.triangleCount()));
        std::copy_n(mesh.indices.begin(), 3 * mesh.triangleCount(), indices);
        impl_->parts.push_back(std::make_unique<PartData>(PartData{parts[id].holes, parts[id].twoSided}));
        rtcSetGeometryUserData(geometry, impl_->parts.back().get());
        if (parts[id].holes != nullptr) {
            rtcSetGeometryIntersectFilterFunction(geometry, filterHoles);
            rtcSetGeometryOccludedFilterFunction(geometry, filterHoles);
        }
        rtcCommitGeometry(geometry);
        rtcAttachGeometryByID(scene, geometry, id);
        rtcReleaseGeometry(geometry);
    }
    rtcCommitScene(scene);
    impl_->scenes.push_back(scene);
    return static_cast<std::uint32_t>(impl_->scenes.size() - 1);
}

struct TracedScene::Impl {
    const TracedMeshes::Impl* meshes = nullptr;
    RTCScene scene = nullptr;
    std::uint32_t placed = 0;

    void renew() {
        if (scene) rtcReleaseScene(scene);
        scene = rtcNewScene(meshes->device);
        rtcSetSceneFlags(scene, sceneFlags);
        rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_MEDIUM);
        placed = 0;
    }
    ~Impl() {
        if (scene) rtcReleaseScene(scene);
    }
};

TracedScene::TracedScene(const TracedMeshes& meshes) : impl_(std::make_unique<Impl>()) {
    impl_->meshes = meshes.impl_.get();
    impl_->renew();
    commit();
}

TracedScene::~TracedScene() = default;
TracedScene::TracedScene(TracedScene&&) noexcept = default;
TracedScene& TracedScene::operator=(TracedScene&&) noexcept = default;

void TracedScene::clear() {
    impl_->renew();
}

std::uint32_t TracedScene::place(std::uint32_t mesh, const glm::mat4& worldFromMesh) {
    RTCGeometry instance = rtcNewGeometry(impl_->meshes->device, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(instance, impl_->meshes->scenes[mesh]);
    rtcSetGeometryTransform(instance, 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, &worldFromMesh[0][0]);
    rtcCommitGeometry(instance);
    rtcAttachGeometryByID(impl_->scene, instance, impl_->placed);
    rtcReleaseGeometry(instance);
    return impl_->placed++;
}

void TracedScene::commit() {
    rtcCommitScene(impl_->scene);
}

void TracedScene::trace(std::span<const TracedRay> rays, std::span<TracedHit> hits, Backs backs) const {
    RayContext context;
    rtcInitIntersectContext(&context.embree);
    context.embree.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    if (backs == Backs::pass) context.embree.filter = filterBacks;
    alignas(64) RTCRayHit16 packed;
    alignas(64) int valid[packet];
    for (std::size_t first = 0; first < rays.size(); first += packet) {
        const auto some = rays.subspan(first, std::min(packet, rays.size() - first));
        context.rays = some.data();
        fill(packed.ray, some, valid);
        for (std::size_t i = 0; i < packet; ++i) {
            packed.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
            packed.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
        }
        rtcIntersect16(valid, impl_->scene, &context.embree, &packed);
        for (std::size_t i = 0; i < some.size(); ++i) {
            TracedHit& hit = hits[first + i];
            hit = {};
            if (packed.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
            hit = {packed.ray.tfar[i],   packed.hit.instID[0][i], packed.hit.geomID[i],
                   packed.hit.primID[i], packed.hit.u[i],         packed.hit.v[i]};
        }
    }
}

void TracedScene::blocked(std::span<const TracedRay> rays, std::span<std::uint8_t> result) const {
    RayContext context;
    rtcInitIntersectContext(&context.embree);
    // One by one: Embree 3.13.5 never returns from rtcOccluded16 where instances are traced with the flag
    // COHERENT (tried: with and without filters and its robust mode; without the flag, or without instances,
    // it returns and agrees).
    for (std::size_t i = 0; i < rays.size(); ++i) {
        context.rays = &rays[i];
        RTCRay ray{};
        ray.org_x = rays[i].origin.x;
        ray.org_y = rays[i].origin.y;
        ray.org_z = rays[i].origin.z;
        ray.dir_x = rays[i].direction.x;
        ray.dir_y = rays[i].direction.y;
        ray.dir_z = rays[i].direction.z;
        ray.tnear = rays[i].from;
        ray.tfar = rays[i].to;
        ray.mask = 0xffffffffu;
        rtcOccluded1(impl_->scene, &context.embree, &ray);
        // Embree marks what is blocked with a far end of minus infinity.
        result[i] = ray.tfar < 0 ? 1 : 0;
    }
}

}  // namespace reflection
