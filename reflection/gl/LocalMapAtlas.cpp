#include "reflection/gl/LocalMapAtlas.h"

#include <algorithm>
#include <array>
#include <vector>

#include "reflection/gl/SoftwareRenderer.h"
#include "reflection/gl/Texture.h"

namespace reflection {

namespace {

constexpr GLenum format = GL_R11F_G11F_B10F;
constexpr std::size_t texelBytes = 4;
/// Cubes in an array that every OpenGL 4.5 grants: 2048 layers, six a cube.
constexpr int grantedLayers = 341;

}  // namespace

struct LocalMapAtlas::Impl {
    struct SizeClass {
        gl::Texture array;
        gl::Texture words;  ///< a view of it
        gl::Texture nearness;
        std::vector<glm::dvec3> centres;
        int layers = 0;
    };
    std::array<SizeClass, localMapFaceSizes.size()> classes;
    /// A software rasteriser makes mipmaps by six small draws a level, with a flush of its pipeline each:
    /// some 10 ms a map, more than drawing it. Filtering on the processor takes a tenth.
    bool software = false;
    bool nearness = false;
    LocalMap map;
    PackedMips mips;

    void filterOnProcessor(LocalMapSlot slot, int faceSize);
    static gl::Texture nearnessOf(int faceSize, int layers);
};

void LocalMapAtlas::Impl::filterOnProcessor(LocalMapSlot slot, int faceSize) {
    const GLuint array = classes[static_cast<std::size_t>(slot.sizeClass)].array.name();
    map.resize(faceSize);
    mips.texels.resize(map.red.size());
    glGetTextureSubImage(
        array, 0, 0, 0, 6 * slot.layer, faceSize, faceSize, 6, GL_RGB, GL_UNSIGNED_INT_10F_11F_11F_REV,
        static_cast<GLsizei>(mips.texels.size() * sizeof(std::uint32_t)), mips.texels.data());
    for (std::size_t i = 0; i < map.red.size(); ++i)
        unpackTexel(mips.texels[i], map.red[i], map.green[i], map.blue[i]);
    packMips(map, mips);
    for (int level = 1; level < mips.levelCount(); ++level) {
        const int side = faceSize >> level;
        glTextureSubImage3D(array, level, 0, 0, 6 * slot.layer, side, side, 6, GL_RGB,
                            GL_UNSIGNED_INT_10F_11F_11F_REV, mips.texels.data() + mips.levelOffset(level));
    }
}

gl::Texture LocalMapAtlas::Impl::nearnessOf(int faceSize, int layers) {
    gl::Texture array = gl::Texture::cubeArray(GL_R16F, faceSize, layers, 1);
    // The nearest: on a plane a mixture would be as right, across an edge wrong, and dearer everywhere.
    array.filter(GL_NEAREST, GL_NEAREST).wrap(GL_CLAMP_TO_EDGE);
    return array;
}

LocalMapAtlas::LocalMapAtlas() : impl_(std::make_unique<Impl>()) {
    impl_->software = softwareRenderer();
}
LocalMapAtlas::~LocalMapAtlas() = default;
LocalMapAtlas::LocalMapAtlas(LocalMapAtlas&&) noexcept = default;
LocalMapAtlas& LocalMapAtlas::operator=(LocalMapAtlas&&) noexcept = default;

void LocalMapAtlas::keepNearness() {
    if (impl_->nearness) return;
    impl_->nearness = true;
    for (std::size_t i = 0; i < impl_->classes.size(); ++i) {
        Impl::SizeClass& c = impl_->classes[i];
        if (c.layers == 0) continue;
        c.nearness = Impl::nearnessOf(localMapFaceSizes[i], c.layers);
    }
}

bool LocalMapAtlas::keepsNearness() const {
    return impl_->nearness;
}

void LocalMapAtlas::reserve(int sizeClass, int layers) {
    Impl::SizeClass& c = impl_->classes[static_cast<std::size_t>(sizeClass)];
    if (layers <= c.layers) return;
    const int grown = std::max(layers, std::min(std::max(4, 2 * c.layers), grantedLayers));
    const int faceSize = localMapFaceSizes[static_cast<std::size_t>(sizeClass)];
    const int levels = gl::mipLevels(faceSize);
    gl::Texture larger = gl::Texture::cubeArray(format, faceSize, grown, levels);
    larger.filter(GL_LINEAR_MIPMAP_LINEAR, GL_LINEAR).wrap(GL_CLAMP_TO_EDGE);
    if (c.layers > 0) {
        for (int level = 0; level < levels; ++level) {
            const int side = faceSize >> level;
            glCopyImageSubData(c.array.name(), GL_TEXTURE_CUBE_MAP_ARRAY, level, 0, 0, 0, larger.name(),
                               GL_TEXTURE_CUBE_MAP_ARRAY, level, 0, 0, 0, side, side, 6 * c.layers);
        }
    }
    if (impl_->nearness) {
        gl::Texture nearness = Impl::nearnessOf(faceSize, grown);
        if (c.layers > 0)
            glCopyImageSubData(c.nearness.name(), GL_TEXTURE_CUBE_MAP_ARRAY, 0, 0, 0, 0, nearness.name(),
                               GL_TEXTURE_CUBE_MAP_ARRAY, 0, 0, 0, 0, faceSize, faceSize, 6 * c.layers);
        c.nearness = std::move(nearness);
    }
    c.centres.resize(static_cast<std::size_t>(grown));
    c.array = std::move(larger);
    c.words = gl::Texture::view(GL_TEXTURE_CUBE_MAP_ARRAY, c.array.name(), GL_R32UI, 0, levels, 0, 6 * grown);
    c.layers = grown;
}

void LocalMapAtlas::upload(LocalMapSlot slot, const PackedMips& mips) {
    const Impl::SizeClass& c = impl_->classes[static_cast<std::size_t>(slot.sizeClass)];
    for (int level = 0; level < mips.levelCount(); ++level) {
        const int side = mips.faceSize >> level;
        glTextureSubImage3D(c.array.name(), level, 0, 0, 6 * slot.layer, side, side, 6, GL_RGB,
                            GL_UNSIGNED_INT_10F_11F_11F_REV, mips.texels.data() + mips.levelOffset(level));
    }
    if (impl_->nearness)
        glTextureSubImage3D(c.nearness.name(), 0, 0, 0, 6 * slot.layer, mips.faceSize, mips.faceSize, 6,
                            GL_RED, GL_HALF_FLOAT, mips.nearness.data());
}

void LocalMapAtlas::setCentre(LocalMapSlot slot, const glm::dvec3& centre) {
    std::vector<glm::dvec3>& centres = impl_->classes[static_cast<std::size_t>(slot.sizeClass)].centres;
    if (static_cast<std::size_t>(slot.layer) < centres.size())
        centres[static_cast<std::size_t>(slot.layer)] = centre;
}

void LocalMapAtlas::download(LocalMapSlot slot, PackedMips& mips) const {
    const Impl::SizeClass& c = impl_->classes[static_cast<std::size_t>(slot.sizeClass)];
    mips.faceSize = localMapFaceSizes[static_cast<std::size_t>(slot.sizeClass)];
    mips.texels.resize(mips.levelOffset(mips.levelCount()));
    for (int level = 0; level < mips.levelCount(); ++level) {
        const int side = mips.faceSize >> level;
        glGetTextureSubImage(c.array.name(), level, 0, 0, 6 * slot.layer, side, side, 6, GL_RGB,
                             GL_UNSIGNED_INT_10F_11F_11F_REV,
                             static_cast<GLsizei>(6 * static_cast<std::size_t>(side * side) * texelBytes),
                             mips.texels.data() + mips.levelOffset(level));
    }
    mips.nearness.assign(mips.levelOffset(1), 0);
    if (impl_->nearness)
        glGetTextureSubImage(c.nearness.name(), 0, 0, 0, 6 * slot.layer, mips.faceSize, mips.faceSize, 6,
                             GL_RED, GL_HALF_FLOAT,
                             static_cast<GLsizei>(mips.nearness.size() * sizeof(std::uint16_t)),
                             mips.nearness.data());
}

CubeTarget LocalMapAtlas::target(LocalMapSlot slot) const {
    CubeTarget target;
    target.colour = impl_->classes[static_cast<std::size_t>(slot.sizeClass)].array.name();
    target.layer = slot.layer;
    target.faceSize = localMapFaceSizes[static_cast<std::size_t>(slot.sizeClass)];
    return target;
}

void LocalMapAtlas::finishDrawn(LocalMapSlot slot) {
    const int faceSize = localMapFaceSizes[static_cast<std::size_t>(slot.sizeClass)];
    if (impl_->software) {
        impl_->filterOnProcessor(slot, faceSize);
        return;
    }
    const gl::Texture one = gl::Texture::view(
        GL_TEXTURE_CUBE_MAP, impl_->classes[static_cast<std::size_t>(slot.sizeClass)].array.name(), format, 0,
        gl::mipLevels(faceSize), 6 * slot.layer, 6);
    glGenerateTextureMipmap(one.name());
}

LocalMapTextures LocalMapAtlas::textures() const {
    LocalMapTextures names;
    for (std::size_t c = 0; c < impl_->classes.size(); ++c) {
        names.cubeArrays[c] = impl_->classes[c].array.name();
        names.nearnessArrays[c] = impl_->classes[c].nearness.name();
        names.centres[c] = impl_->classes[c].centres;
    }
    return names;
}

std::uint32_t LocalMapAtlas::wordArray(int sizeClass) const {
    return impl_->classes[static_cast<std::size_t>(sizeClass)].words.name();
}

std::uint32_t LocalMapAtlas::nearnessArray(int sizeClass) const {
    return impl_->classes[static_cast<std::size_t>(sizeClass)].nearness.name();
}

std::size_t LocalMapAtlas::bytes() const {
    std::size_t total = 0;
    for (std::size_t c = 0; c < impl_->classes.size(); ++c) {
        const auto texels = static_cast<std::size_t>(localMapFaceSizes[c] * localMapFaceSizes[c]);
        if (impl_->nearness)
            total += static_cast<std::size_t>(impl_->classes[c].layers) * 6 * texels * sizeof(std::uint16_t);
        for (int side = localMapFaceSizes[c]; side > 0; side /= 2)
            total += static_cast<std::size_t>(impl_->classes[c].layers) * 6 * static_cast<std::size_t>(side) *
                     static_cast<std::size_t>(side) * texelBytes;
    }
    return total;
}

}  // namespace reflection
