#include "app/render/Readback.h"

#include <cstring>

namespace app {

namespace {

void readInto(std::uint32_t framebuffer, glm::ivec2 size, void* destination) {
    glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer);
    glReadBuffer(framebuffer == 0 ? GL_BACK : GL_COLOR_ATTACHMENT0);
    glPixelStorei(GL_PACK_ALIGNMENT, 4);
    glReadPixels(0, 0, size.x, size.y, GL_RGBA, GL_UNSIGNED_BYTE, destination);
}

/// OpenGL's row 0 is the bottom one.
void copyFlipped(const std::uint8_t* from, glm::ivec2 size, std::uint8_t* to) {
    const std::size_t row = static_cast<std::size_t>(size.x) * 4;
    for (int y = 0; y < size.y; ++y)
        std::memcpy(to + row * static_cast<std::size_t>(size.y - 1 - y),
                    from + row * static_cast<std::size_t>(y), row);
}

}  // namespace

Image8 readPixels(std::uint32_t framebuffer, glm::ivec2 size) {
    Image8 image;
    if (size.x <= 0 || size.y <= 0) return image;
    image.size = size;
    image.rgba.resize(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) * 4);
    std::vector<std::uint8_t> pixels(image.rgba.size());
    glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
    readInto(framebuffer, size, pixels.data());
    copyFlipped(pixels.data(), size, image.rgba.data());
    return image;
}

DelayedReadback::DelayedReadback()
    : buffers_{reflection::gl::Buffer::create(), reflection::gl::Buffer::create()} {}

std::optional<Image8> DelayedReadback::exchange(std::uint32_t framebuffer, glm::ivec2 size) {
    if (size.x <= 0 || size.y <= 0) return std::nullopt;
    const std::size_t slot = next_;
    next_ = 1 - next_;
    glBindBuffer(GL_PIXEL_PACK_BUFFER, buffers_[slot].name());
    if (sizes_[slot] != size) {
        sizes_[slot] = size;
        glBufferData(GL_PIXEL_PACK_BUFFER, static_cast<GLsizeiptr>(size.x) * size.y * 4, nullptr,
                     GL_STREAM_READ);
    }
    readInto(framebuffer, size, nullptr);
    glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
    pending_[slot] = true;
    return take(1 - slot);
}

std::optional<Image8> DelayedReadback::finish() {
    return take(1 - next_);
}

std::optional<Image8> DelayedReadback::take(std::size_t slot) {
    if (!pending_[slot]) return std::nullopt;
    pending_[slot] = false;
    Image8 image;
    image.size = sizes_[slot];
    image.rgba.resize(static_cast<std::size_t>(image.size.x) * static_cast<std::size_t>(image.size.y) * 4);
    const void* mapped = glMapNamedBufferRange(buffers_[slot].name(), 0,
                                               static_cast<GLsizeiptr>(image.rgba.size()), GL_MAP_READ_BIT);
    if (mapped == nullptr) return std::nullopt;
    copyFlipped(static_cast<const std::uint8_t*>(mapped), image.size, image.rgba.data());
    glUnmapNamedBuffer(buffers_[slot].name());
    return image;
}

}  // namespace app
