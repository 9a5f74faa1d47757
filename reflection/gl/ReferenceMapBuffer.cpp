#include "reflection/gl/ReferenceMapBuffer.h"

#include <algorithm>
#include <cstring>
#include <unordered_map>
#include <vector>

#include "reflection/gl/Buffer.h"
#include "reflection/gl/Texture.h"

namespace reflection {

namespace {

constexpr std::size_t none = static_cast<std::size_t>(-1);

constexpr std::size_t uintsFor(std::size_t bytes) {
    return (bytes + 3) / 4;
}

std::size_t wordUints(const PackedReferenceMap::Level& level) {
    return uintsFor(PackedReferenceMap::Level::wordBytes(level.faceSize()));
}
std::size_t chromaUints(const PackedReferenceMap::Level& level) {
    return uintsFor(PackedReferenceMap::Level::chromaCount(level.faceSize()) * sizeof(std::uint16_t));
}
std::size_t uintsOf(const PackedReferenceMap& map) {
    std::size_t total = 0;
    for (const PackedReferenceMap::Level& level : map.levels())
        total += wordUints(level) + chromaUints(level);
    return total;
}

}  // namespace

struct ReferenceMapBuffer::Impl {
    struct Place {
        const PackedReferenceMap* map = nullptr;
        std::uint64_t lastBatch = 0;
    };
    gl::Buffer buffer;
    gl::Texture texels;  ///< of the buffer
    gl::Buffer staging;
    std::size_t placeUints = 0;
    std::vector<Place> places;
    std::unordered_map<const PackedReferenceMap*, std::size_t> placeOf;
    std::uint64_t batch = 1;
    std::size_t heldBytes = 0, heldTexels = 0, uploads = 0;
    std::vector<std::uint32_t> packed;

    std::size_t freePlace() const;
    void upload(const PackedReferenceMap& map, std::size_t place);
};

ReferenceMapBuffer::ReferenceMapBuffer(std::span<const PackedReferenceMap> maps, std::size_t budget)
    : impl_(std::make_unique<Impl>()) {
    for (const PackedReferenceMap& map : maps) impl_->placeUints = std::max(impl_->placeUints, uintsOf(map));
    GLint64 greatest = 0;
    glGetInteger64v(GL_MAX_TEXTURE_BUFFER_SIZE, &greatest);
    const std::size_t placeBytes = 4 * impl_->placeUints;
    std::size_t count = 0;
    if (placeBytes > 0) {
        const std::size_t allowed = 4 * static_cast<std::size_t>(std::max<GLint64>(greatest, 0)) / placeBytes;
        count = std::min({maps.size(), std::max<std::size_t>(budget / placeBytes, 1), allowed});
    }
    while (glGetError() != GL_NO_ERROR) {
        // Whatever was wrong before is not about this memory.
    }
    impl_->buffer = gl::Buffer::sized(std::max<std::size_t>(count * placeBytes, 4));
    while (count > 0 && glGetError() == GL_OUT_OF_MEMORY) {
        count /= 2;
        impl_->buffer = gl::Buffer::sized(std::max<std::size_t>(count * placeBytes, 4));
    }
    impl_->places.resize(count);
    impl_->texels = gl::Texture::buffer(GL_R32UI, impl_->buffer.name());
    impl_->staging = gl::Buffer::create();
}

ReferenceMapBuffer::~ReferenceMapBuffer() = default;

std::size_t ReferenceMapBuffer::places() const {
    return impl_->places.size();
}

void ReferenceMapBuffer::startBatch() {
    ++impl_->batch;
}

std::size_t ReferenceMapBuffer::Impl::freePlace() const {
    std::size_t oldest = none;
    for (std::size_t i = 0; i < places.size(); ++i) {
        if (places[i].map == nullptr) return i;
        if (places[i].lastBatch == batch) continue;
        if (oldest == none || places[i].lastBatch < places[oldest].lastBatch) oldest = i;
    }
    return oldest;
}

bool ReferenceMapBuffer::hold(const PackedReferenceMap& map) {
    Impl& self = *impl_;
    if (const auto held = self.placeOf.find(&map); held != self.placeOf.end()) {
        self.places[held->second].lastBatch = self.batch;
        return true;
    }
    const std::size_t place = self.freePlace();
    if (place == none) return false;
    if (const PackedReferenceMap* old = self.places[place].map) {
        self.placeOf.erase(old);
        self.heldBytes -= old->bytes();
        self.heldTexels -= old->texelCount();
    }
    self.upload(map, place);
    self.places[place] = {&map, self.batch};
    self.placeOf[&map] = place;
    self.heldBytes += map.bytes();
    self.heldTexels += map.texelCount();
    return true;
}

void ReferenceMapBuffer::Impl::upload(const PackedReferenceMap& map, std::size_t place) {
    packed.assign(uintsOf(map), 0);
    std::uint32_t* to = packed.data();
    for (const PackedReferenceMap::Level& level : map.levels()) {
        const int n = level.faceSize();
        std::memcpy(to, level.words(), PackedReferenceMap::Level::wordBytes(n));
        to += wordUints(level);
        std::memcpy(to, level.chroma(), PackedReferenceMap::Level::chromaCount(n) * sizeof(std::uint16_t));
        to += chromaUints(level);
    }
    // Written directly, a buffer that the GPU still reads would have to be waited for; a copy has its turn
    // there.
    staging.replace(std::span<const std::uint32_t>(packed), GL_STREAM_COPY);
    glCopyNamedBufferSubData(staging.name(), buffer.name(), 0, static_cast<GLintptr>(4 * place * placeUints),
                             static_cast<GLsizeiptr>(4 * packed.size()));
    ++uploads;
}

BufferedLevel ReferenceMapBuffer::levelOf(const PackedReferenceMap& map,
                                          const PackedReferenceMap::Level& level) const {
    std::size_t at = impl_->placeOf.at(&map) * impl_->placeUints;
    for (const PackedReferenceMap::Level& other : map.levels()) {
        if (&other == &level) break;
        at += wordUints(other) + chromaUints(other);
    }
    return {static_cast<std::uint32_t>(at), static_cast<std::uint32_t>(at + wordUints(level))};
}

std::uint32_t ReferenceMapBuffer::name() const {
    return impl_->texels.name();
}
std::size_t ReferenceMapBuffer::bytes() const {
    return 4 * impl_->places.size() * impl_->placeUints;
}
std::size_t ReferenceMapBuffer::heldBytes() const {
    return impl_->heldBytes;
}
std::size_t ReferenceMapBuffer::heldTexels() const {
    return impl_->heldTexels;
}
std::size_t ReferenceMapBuffer::uploads() const {
    return impl_->uploads;
}

}  // namespace reflection
