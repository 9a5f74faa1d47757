#include "reflection/gl/ChromeLayer.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <array>
#include <utility>

namespace reflection::gl {

void ChromeLayer::begin(const glm::ivec2& viewSize, const PixelRect& rectangle) {
    if (size_.x < viewSize.x || size_.y < viewSize.y) {
        size_ = glm::max(size_, viewSize);
        colour_ = Texture::image2D(GL_RGBA16F, size_.x, size_.y);
        colour_.filter(GL_NEAREST, GL_NEAREST).wrap(GL_CLAMP_TO_EDGE);
        depth_ = Texture::image2D(GL_DEPTH_COMPONENT32F, size_.x, size_.y);
        framebuffer_ = Framebuffer::create();
        framebuffer_.attach(GL_COLOR_ATTACHMENT0, colour_.name()).attach(GL_DEPTH_ATTACHMENT, depth_.name());
        framebuffer_.requireComplete("virtual objects in chrome");
    }
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
    glViewport(0, 0, viewSize.x, viewSize.y);
    glEnable(GL_SCISSOR_TEST);
    glScissor(rectangle.low.x, rectangle.low.y, rectangle.size().x, rectangle.size().y);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_GEQUAL);
    glDepthMask(GL_TRUE);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glDisable(GL_BLEND);
    constexpr std::array<float, 4> nothing{};
    constexpr float far = 0;
    glClearNamedFramebufferfv(framebuffer_.name(), GL_COLOR, 0, nothing.data());
    glClearNamedFramebufferfv(framebuffer_.name(), GL_DEPTH, 0, &far);
}

void ChromeLayer::beginMask() {
    constexpr float nearest = 1;
    glClearNamedFramebufferfv(framebuffer_.name(), GL_DEPTH, 0, &nearest);
    // Every pixel that is drawn becomes infinitely far.
    glDepthFunc(GL_ALWAYS);
    glDepthRangef(0, 0);
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
}

void ChromeLayer::endMask() {
    glDepthFunc(GL_GEQUAL);
    glDepthRangef(0, 1);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
}

ChromeMesh::ChromeMesh(std::vector<int> attributes) {
    for (const int floats : attributes) stride_ += static_cast<std::size_t>(floats);
    array_.buffer(0, places_.name(), sizeof(VirtualVertex))
        .attribute(0, 0, 3, GL_FLOAT, false, offsetof(VirtualVertex, fromEye))
        .buffer(1, values_.name(), static_cast<GLsizei>(stride_ * sizeof(float)))
        .indices(indices_.name());
    GLuint location = 1, offset = 0;
    for (const int floats : attributes) {
        array_.attribute(location++, 1, floats, GL_FLOAT, false, offset);
        offset += static_cast<GLuint>(floats) * sizeof(float);
    }
}

void ChromeMesh::mix(const VirtualMesh& mesh, std::span<const float> ofVertices) {
    all_.assign(ofVertices.begin(), ofVertices.end());
    for (const MiddleVertex& m : mesh.middles())
        for (std::size_t k = 0; k < stride_; ++k) {
            const float a = all_[m.a * stride_ + k], b = all_[m.b * stride_ + k];
            all_.push_back(a + m.share * (b - a));
        }
}

void ChromeMesh::upload(std::span<const Part> parts, const VirtualWindow& window) {
    std::vector<std::pair<float, const Part*>> order;
    for (const Part& part : parts)
        if (!part.mesh->indices().empty()) order.emplace_back(part.mesh->away(), &part);
    std::ranges::stable_sort(order, {}, &std::pair<float, const Part*>::first);
    joined_.clear();
    vertices_.clear();
    corners_.clear();
    constexpr std::uint32_t none = ~std::uint32_t{0};
    for (const auto& [away, part] : order) {
        const std::span<const VirtualVertex> vertices = part->mesh->vertices();
        showing(vertices, part->mesh->indices(), window, shown_);
        if (shown_.empty()) continue;
        mix(*part->mesh, part->ofVertices);
        numbers_.assign(vertices.size(), none);
        for (const std::uint32_t v : shown_) {
            std::uint32_t& number = numbers_[v];
            if (number == none) {
                number = static_cast<std::uint32_t>(vertices_.size());
                vertices_.push_back(vertices[v]);
                const float* values = all_.data() + v * stride_;
                joined_.insert(joined_.end(), values, values + stride_);
            }
            corners_.push_back(number);
        }
    }
    places_.replace(std::span<const VirtualVertex>(vertices_));
    values_.replace(std::span<const float>(joined_));
    indices_.replace(std::span<const std::uint32_t>(corners_));
    count_ = static_cast<GLsizei>(corners_.size());
}

void ChromeMesh::upload(const VirtualMesh& mesh, std::span<const float> ofVertices) {
    mix(mesh, ofVertices);
    places_.replace(mesh.vertices());
    values_.replace(std::span<const float>(all_));
    indices_.replace(mesh.indices());
    count_ = static_cast<GLsizei>(mesh.indices().size());
}

void ChromeMesh::upload(const VirtualMesh& mesh, std::span<const float> ofVertices,
                        const VirtualWindow& window) {
    const Part part{&mesh, ofVertices};
    upload(std::span(&part, 1), window);
}

void ChromeMesh::draw() const {
    if (count_ == 0) return;
    array_.bind();
    glDrawElements(GL_TRIANGLES, count_, GL_UNSIGNED_INT, nullptr);
}

}  // namespace reflection::gl
