#include "app/render/ShadowMap.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace app {

namespace {

/// The sun's disc is half a degree wide: smaller steps than this do not show.
constexpr float redrawCosine = 0.99999391f;  // 0.2 degrees

/// World to clip space of a parallel view along the sun's light that just holds the box, depth 1 at the side
/// of the sun.
glm::mat4 clipAlong(const glm::vec3& sun, const city::Aabb& box) {
    const glm::vec3 side = std::abs(sun.z) > 0.99f ? glm::vec3(0, 1, 0) : glm::vec3(0, 0, 1);
    const glm::vec3 u = glm::normalize(glm::cross(side, sun));
    const glm::vec3 v = glm::cross(sun, u);
    city::Aabb seen;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::vec3 p((corner & 1) != 0 ? box.max.x : box.min.x,
                          (corner & 2) != 0 ? box.max.y : box.min.y,
                          (corner & 4) != 0 ? box.max.z : box.min.z);
        seen.extend(glm::vec3(glm::dot(u, p), glm::dot(v, p), glm::dot(sun, p)));
    }
    const glm::vec3 half = glm::max(0.5f * seen.size(), glm::vec3(1.f)) * 1.01f;
    const glm::vec3 centre = seen.centre();
    glm::mat4 clip(0);
    for (int i = 0; i < 3; ++i) clip[i] = glm::vec4(u[i] / half.x, v[i] / half.y, 0.5f * sun[i] / half.z, 0);
    clip[3] = glm::vec4(-centre.x / half.x, -centre.y / half.y, 0.5f - 0.5f * centre.z / half.z, 1);
    return clip;
}

}  // namespace

ShadowMap::ShadowMap(const city::Aabb& box, int size) : box_(box), size_(size) {
    using namespace reflection::gl;
    if (box_.empty()) box_ = {glm::vec3(-1), glm::vec3(1)};
    map_ = Texture::image2D(GL_DEPTH_COMPONENT16, size, size);
    map_.filter(GL_LINEAR, GL_LINEAR).wrap(GL_CLAMP_TO_BORDER);
    const float border[4] = {0, 0, 0, 0};  // outside: nothing between here and the sun
    glTextureParameterfv(map_.name(), GL_TEXTURE_BORDER_COLOR, border);
    glTextureParameteri(map_.name(), GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
    glTextureParameteri(map_.name(), GL_TEXTURE_COMPARE_FUNC, GL_GEQUAL);
    target_ = Framebuffer::create();
    target_.attach(GL_DEPTH_ATTACHMENT, map_.name());
    glNamedFramebufferDrawBuffer(target_.name(), GL_NONE);
    target_.requireComplete("the sun's shadows");
}

std::shared_ptr<const SunMap> ShadowMap::read() const {
    auto map = std::make_shared<SunMap>();
    map->shadowFromWorld = shadowFromWorld_;
    map->normalOffset = normalOffset_;
    map->size = size_;
    map->depth.resize(static_cast<std::size_t>(size_) * static_cast<std::size_t>(size_));
    glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
    glPixelStorei(GL_PACK_ALIGNMENT, 2);
    // The size in bytes is an int in OpenGL: rows by rows, as 16384 texels a side would not fit one call.
    constexpr int rows = 1024;
    for (int first = 0; first < size_; first += rows) {
        const int count = std::min(rows, size_ - first);
        glGetTextureSubImage(map_.name(), 0, 0, first, 0, size_, count, 1, GL_DEPTH_COMPONENT,
                             GL_UNSIGNED_SHORT, size_ * count * 2,
                             &map->depth[static_cast<std::size_t>(first) * static_cast<std::size_t>(size_)]);
    }
    return map;
}

bool ShadowMap::update(const glm::vec3& sunDirection, const std::function<void(const PassView&)>& drawDepth) {
    if (glm::dot(sunDirection, sun_) > redrawCosine) return false;
    sun_ = sunDirection;
    const glm::mat4 clip = clipAlong(sun_, box_);
    // Half a texel's diagonal covers a receiver that is parallel to the light; the rest is for 16 bit depth.
    const float texel =
        2.f / (glm::length(glm::vec3(clip[0][0], clip[1][0], clip[2][0])) * static_cast<float>(size_));
    const float texelV =
        2.f / (glm::length(glm::vec3(clip[0][1], clip[1][1], clip[2][1])) * static_cast<float>(size_));
    normalOffset_ = 1.5f * std::max(texel, texelV) + 0.01f;
    glm::mat4 textureFromClip(1);
    textureFromClip[0][0] = textureFromClip[1][1] = 0.5f;
    textureFromClip[3] = glm::vec4(0.5f, 0.5f, 0, 1);
    shadowFromWorld_ = textureFromClip * clip;

    glBindFramebuffer(GL_FRAMEBUFFER, target_.name());
    glViewport(0, 0, size_, size_);
    glClearDepth(0);
    glClear(GL_DEPTH_BUFFER_BIT);
    glEnable(GL_POLYGON_OFFSET_FILL);
    glPolygonOffset(-1.5f, -2.f);  // away from the sun, as depth runs reversed
    PassView view(glm::dvec3(0), clip, 1 / std::max(texel, texelV));
    view.parallel = true;
    drawDepth(view);
    glDisable(GL_POLYGON_OFFSET_FILL);
    return true;
}

}  // namespace app
