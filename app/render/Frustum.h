#pragma once

#include <array>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "city/geometry/Aabb.h"

namespace app {

/// The five planes (sides and near; depth is reversed and the far plane at infinity) of a view, in world axes
/// around the eye. Tests may keep what is outside, never drop what is inside.
class Frustum {
  public:
    explicit Frustum(const glm::mat4& clipFromRelative) {
        const auto row = [&](int i) {
            return glm::vec4(clipFromRelative[0][i], clipFromRelative[1][i], clipFromRelative[2][i],
                             clipFromRelative[3][i]);
        };
        planes_ = {row(3) + row(0), row(3) - row(0), row(3) + row(1), row(3) - row(1), row(3) - row(2)};
        for (glm::vec4& p : planes_) {
            const float length = glm::length(glm::vec3(p));
            if (length > 0) p /= length;
        }
    }

    /// A box, relative to the eye.
    bool touches(const glm::vec3& centre, const glm::vec3& halfSize) const {
        for (const glm::vec4& p : planes_) {
            const glm::vec3 n(p);
            if (glm::dot(n, centre) + p.w + glm::dot(glm::abs(n), halfSize) < 0) return false;
        }
        return true;
    }
    bool touches(const glm::vec3& centre, float radius) const {
        for (const glm::vec4& p : planes_)
            if (glm::dot(glm::vec3(p), centre) + p.w < -radius) return false;
        return true;
    }

  private:
    std::array<glm::vec4, 5> planes_;
};

}  // namespace app
