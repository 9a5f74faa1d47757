#include "reflection/gl/ChromeSearchMesh.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>

namespace reflection {

ChromeSearchMesh::ChromeSearchMesh(const ReflectorMap& map, int floatsPerVertex)
    : map_(map), floats_(static_cast<std::size_t>(floatsPerVertex)) {}

void ChromeSearchMesh::add(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices,
                           std::span<const float> ofVertices) {
    const auto first = static_cast<std::uint32_t>(vertexCount());
    for (const glm::vec3& p : positions) {
        const glm::vec3 at(glm::dvec3(p) - map_.map().frame().centre);
        positions_.insert(positions_.end(), {at.x, at.y, at.z});
    }
    values_.insert(values_.end(), ofVertices.begin(), ofVertices.end());
    values_.resize(vertexCount() * floats_, 0.0f);
    for (std::size_t k = 0; k + 2 < indices.size(); k += 3)
        cut({first + indices[k], first + indices[k + 1], first + indices[k + 2]}, 0);
    middles_.clear();
    changed_ = true;
}

double ChromeSearchMesh::angleOf(std::uint32_t a, std::uint32_t b) const {
    const auto at = [&](std::size_t v) {
        return glm::dvec3(positions_[3 * v], positions_[3 * v + 1], positions_[3 * v + 2]);
    };
    const glm::dvec3 p = at(a), q = at(b);
    return std::atan2(glm::length(glm::cross(p, q)), glm::dot(p, q));
}

std::uint32_t ChromeSearchMesh::middleOf(std::uint32_t a, std::uint32_t b) {
    const std::uint64_t key = (static_cast<std::uint64_t>(std::min(a, b)) << 32) | std::max(a, b);
    const auto [entry, added] = middles_.try_emplace(key, static_cast<std::uint32_t>(vertexCount()));
    if (added) {
        for (std::size_t k = 0; k < 3; ++k)
            positions_.push_back(0.5f * (positions_[3 * a + k] + positions_[3 * b + k]));
        for (std::size_t k = 0; k < floats_; ++k)
            values_.push_back(0.5f * (values_[floats_ * a + k] + values_[floats_ * b + k]));
    }
    return entry->second;
}

/// The edge seen under the greatest angle first. Whether an edge is halved depends on its ends alone, so that
/// both triangles at it end up with the same middles and no cracks open.
void ChromeSearchMesh::cut(const std::array<std::uint32_t, 3>& t, int depth) {
    std::size_t longest = 0;
    double most = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const double angle = angleOf(t[k], t[(k + 1) % 3]);
        if (angle > most) most = angle, longest = k;
    }
    // An angle that is not a number is not greater.
    if (!(most > longestEdge) || depth >= mostCuts) {
        indices_.insert(indices_.end(), t.begin(), t.end());
        return;
    }
    const std::uint32_t a = t[longest], b = t[(longest + 1) % 3], c = t[(longest + 2) % 3];
    const std::uint32_t middle = middleOf(a, b);
    cut({a, middle, c}, depth + 1);
    cut({middle, b, c}, depth + 1);
}

void ChromeSearchMesh::makeBuffers() {
    given_ = gl::Buffer::filled(std::span<const float>(positions_));
    host_ = gl::Buffer::filled(std::span<const float>(values_));
    drawn_ = gl::Buffer::filled(std::span<const std::uint32_t>(indices_));
    results_ = gl::Buffer::sized(std::max<std::size_t>(vertexCount(), 1) * sizeof(GpuReflection));
    array_ = gl::VertexArray::create();
    array_.buffer(0, results_.name(), sizeof(GpuReflection))
        .attribute(0, 0, 3, GL_FLOAT, false, offsetof(GpuReflection, fromEye))
        .integerAttribute(2, 0, 1, GL_UNSIGNED_INT, offsetof(GpuReflection, status))
        .buffer(1, host_.name(), static_cast<GLsizei>(floats_ * sizeof(float)))
        .attribute(1, 1, static_cast<GLint>(floats_), GL_FLOAT, false, 0)
        .indices(drawn_.name());
    changed_ = false;
}

void ChromeSearchMesh::update(ChromeSearch& search, const glm::dvec3& eye) {
    if (changed_) makeBuffers();
    if (vertexCount() > 0) search.search(map_, eye, given_.name(), vertexCount(), results_.name());
}

void ChromeSearchMesh::draw() const {
    if (indices_.empty() || !results_) return;
    array_.bind();
    glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(indices_.size()), GL_UNSIGNED_INT, nullptr);
}

}  // namespace reflection
