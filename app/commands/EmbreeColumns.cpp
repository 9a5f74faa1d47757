#include "app/commands/EmbreeColumns.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

namespace app {

namespace {

struct Box {
    int i0, j0, i1, j1;
    float top;
};

/// Greedy rectangles of equal height.
std::vector<Box> boxesOf(const city::Heightfield& field) {
    std::vector<Box> boxes;
    std::vector<bool> taken(field.cells().size(), false);
    const int width = field.width(), height = field.height();
    const auto index = [&](int i, int j) {
        return static_cast<std::size_t>(j) * static_cast<std::size_t>(width) + static_cast<std::size_t>(i);
    };
    for (int j = 0; j < height; ++j)
        for (int i = 0; i < width; ++i) {
            const float h = field.at(i, j);
            if (taken[index(i, j)] || !std::isfinite(h)) continue;
            int i1 = i + 1;
            while (i1 < width && !taken[index(i1, j)] && field.at(i1, j) == h) ++i1;
            int j1 = j + 1;
            const auto rowFits = [&] {
                for (int k = i; k < i1; ++k)
                    if (taken[index(k, j1)] || field.at(k, j1) != h) return false;
                return true;
            };
            while (j1 < height && rowFits()) ++j1;
            for (int v = j; v < j1; ++v)
                for (int k = i; k < i1; ++k) taken[index(k, v)] = true;
            boxes.push_back({i, j, i1, j1, h});
        }
    return boxes;
}

}  // namespace

struct EmbreeColumns::Scene {
    RTCDevice device = nullptr;
    RTCScene scene = nullptr;

    ~Scene() {
        if (scene != nullptr) rtcReleaseScene(scene);
        if (device != nullptr) rtcReleaseDevice(device);
    }
};

EmbreeColumns::~EmbreeColumns() = default;
EmbreeColumns::EmbreeColumns(EmbreeColumns&&) noexcept = default;
EmbreeColumns& EmbreeColumns::operator=(EmbreeColumns&&) noexcept = default;

EmbreeColumns::EmbreeColumns(const city::Heightfield& field, bool robust)
    : scene_(std::make_unique<Scene>()) {
    const std::vector<Box> boxes = boxesOf(field);
    scene_->device = rtcNewDevice(nullptr);
    if (scene_->device == nullptr)
        throw std::runtime_error("Embree: no device could be made; leave Embree out of the bench");
    scene_->scene = rtcNewScene(scene_->device);
    rtcSetSceneFlags(scene_->scene, robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
    rtcSetSceneBuildQuality(scene_->scene, RTC_BUILD_QUALITY_HIGH);
    RTCGeometry quads = rtcNewGeometry(scene_->device, RTC_GEOMETRY_TYPE_QUAD);
    auto* vertex = static_cast<float*>(rtcSetNewGeometryBuffer(
        quads, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), boxes.size() * 8));
    auto* corner = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
        quads, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT4, 4 * sizeof(unsigned), boxes.size() * 5));
    float bottom = std::numeric_limits<float>::infinity();
    for (const Box& box : boxes) bottom = std::min(bottom, box.top);
    bottom -= 1;
    if (!boxes.empty() && (vertex == nullptr || corner == nullptr)) {
        rtcReleaseGeometry(quads);
        throw std::runtime_error("Embree: no memory for " + std::to_string(boxes.size()) +
                                 " boxes; bench a smaller city");
    }
    unsigned base = 0;
    for (const Box& box : boxes) {
        for (unsigned c = 0; c < 8; ++c) {
            *vertex++ =
                static_cast<float>(field.origin().x + ((c & 1) != 0 ? box.i1 : box.i0) * field.cellSize());
            *vertex++ =
                static_cast<float>(field.origin().y + ((c & 2) != 0 ? box.j1 : box.j0) * field.cellSize());
            *vertex++ = (c & 4) != 0 ? box.top : bottom;
        }
        constexpr std::array<std::array<unsigned, 4>, 5> faces{
            {{4, 5, 7, 6}, {0, 1, 5, 4}, {1, 3, 7, 5}, {3, 2, 6, 7}, {2, 0, 4, 6}}};
        for (const auto& face : faces)
            for (const unsigned c : face) *corner++ = base + c;
        base += 8;
    }
    rtcCommitGeometry(quads);
    rtcAttachGeometry(scene_->scene, quads);
    rtcReleaseGeometry(quads);
    rtcCommitScene(scene_->scene);
}

void EmbreeColumns::single(std::span<const city::Ray> rays, std::span<float> t) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    for (std::size_t k = 0; k < rays.size(); ++k) {
        const glm::vec3& o = rays[k].origin;
        const glm::vec3& d = rays[k].direction;
        RTCRayHit query{};
        query.ray = {o.x, o.y, o.z, 0, d.x, d.y, d.z, 0, std::numeric_limits<float>::infinity(), ~0u, 0, 0};
        query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(scene_->scene, &context, &query);
        t[k] = query.ray.tfar;
    }
}

void EmbreeColumns::packets(std::span<const city::Ray> rays, std::span<float> t) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    alignas(64) RTCRayHit16 query;
    alignas(64) int valid[16];
    for (std::size_t first = 0; first < rays.size(); first += 16) {
        const std::size_t count = std::min<std::size_t>(16, rays.size() - first);
        for (std::size_t k = 0; k < 16; ++k) {
            const city::Ray& ray = rays[first + std::min(k, count - 1)];
            valid[k] = k < count ? -1 : 0;
            query.ray.org_x[k] = ray.origin.x;
            query.ray.org_y[k] = ray.origin.y;
            query.ray.org_z[k] = ray.origin.z;
            query.ray.dir_x[k] = ray.direction.x;
            query.ray.dir_y[k] = ray.direction.y;
            query.ray.dir_z[k] = ray.direction.z;
            query.ray.tnear[k] = 0;
            query.ray.tfar[k] = std::numeric_limits<float>::infinity();
            query.ray.time[k] = 0;
            query.ray.mask[k] = ~0u;
            query.ray.id[k] = 0;
            query.ray.flags[k] = 0;
            query.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
        }
        rtcIntersect16(valid, scene_->scene, &context, &query);
        for (std::size_t k = 0; k < count; ++k) t[first + k] = query.ray.tfar[k];
    }
}

}  // namespace app
