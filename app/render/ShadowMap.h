#pragma once

#include <functional>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <memory>

#include "app/frame/SunMap.h"
#include "app/render/PassTarget.h"
#include "city/geometry/Aabb.h"
#include "reflection/gl/Framebuffer.h"
#include "reflection/gl/Texture.h"

namespace app {

/// The shadow map of the static city: drawn once for a position of the sun and kept until it moves.
class ShadowMap {
  public:
    /// `box` holds everything that casts or receives; `size` texels a side.
    ShadowMap(const city::Aabb& box, int size);

    /// Draws the map anew when the sun stands more than 0.2 degrees from where it stood when the map was
    /// drawn, by calling drawDepth with the framebuffer bound. Returns whether it did.
    bool update(const glm::vec3& sunDirection, const std::function<void(const PassView&)>& drawDepth);

    /// Texture coordinates (xy) and depth (z) of a world position; the depth comparison is GL_GEQUAL, 1
    /// nearest to the sun.
    const glm::mat4& shadowFromWorld() const { return shadowFromWorld_; }
    /// Metres by which receivers are moved along their normal before the lookup.
    float normalOffset() const { return normalOffset_; }
    /// Copies the map to main memory.
    std::shared_ptr<const SunMap> read() const;
    const reflection::gl::Texture& texture() const { return map_; }

  private:
    city::Aabb box_;
    int size_;
    glm::vec3 sun_{0};
    glm::mat4 shadowFromWorld_{1};
    float normalOffset_ = 0;
    reflection::gl::Texture map_;
    reflection::gl::Framebuffer target_;
};

}  // namespace app
