#include "reflection/gl/ReferenceMapBaker.h"

#include <array>
#include <span>
#include <stdexcept>
#include <vector>

#include "reflection/gl/Texture.h"

namespace reflection {

namespace {

constexpr int greatestSupersampling = 4;

}  // namespace

struct ReferenceMapBaker::Impl {
    int faceSize;
    int supersampling;
    gl::Texture colour, distance;
    std::vector<float> colourPixels, distancePixels;
};

ReferenceMapBaker::ReferenceMapBaker(int faceSize, int supersampling) : impl_(std::make_unique<Impl>()) {
    if (faceSize < 1 || supersampling < 1 || supersampling > greatestSupersampling)
        throw std::invalid_argument("a reference map needs a positive face size and 1 to 4 samples a side");
    impl_->faceSize = faceSize;
    impl_->supersampling = supersampling;
    const int drawn = faceSize * supersampling;
    impl_->colour = gl::Texture::cubeArray(GL_RGBA16F, drawn, 1);
    impl_->distance = gl::Texture::cubeArray(GL_R32F, drawn, 1);
}

ReferenceMapBaker::~ReferenceMapBaker() = default;

ReferenceMap ReferenceMapBaker::bake(SceneDrawer& drawer, const glm::dvec3& centre,
                                     const CubeContent& content) {
    const int n = impl_->faceSize;
    const int k = impl_->supersampling;
    const auto drawn = static_cast<std::size_t>(n) * static_cast<std::size_t>(k);
    CubeTarget target;
    target.colour = impl_->colour.name();
    target.distance = impl_->distance.name();
    target.faceSize = n * k;
    drawer.drawCube(centre, target, content);

    impl_->colourPixels.resize(6 * drawn * drawn * 3);
    impl_->distancePixels.resize(6 * drawn * drawn);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glGetTextureImage(impl_->colour.name(), 0, GL_RGB, GL_FLOAT,
                      static_cast<GLsizei>(impl_->colourPixels.size() * sizeof(float)),
                      impl_->colourPixels.data());
    glGetTextureImage(impl_->distance.name(), 0, GL_RED, GL_FLOAT,
                      static_cast<GLsizei>(impl_->distancePixels.size() * sizeof(float)),
                      impl_->distancePixels.data());

    ReferenceMap map;
    map.position = centre;
    map.faceSize = n;
    map.colour.resize(map.texelCount());
    map.distance.resize(map.texelCount());
    std::array<float, greatestSupersampling * greatestSupersampling> samples;
    std::size_t out = 0;
    for (std::size_t face = 0; face < 6; ++face) {
        for (std::size_t y = 0; y < static_cast<std::size_t>(n); ++y) {
            for (std::size_t x = 0; x < static_cast<std::size_t>(n); ++x, ++out) {
                glm::vec3 sum(0);
                std::size_t count = 0;
                for (std::size_t sy = 0; sy < static_cast<std::size_t>(k); ++sy) {
                    for (std::size_t sx = 0; sx < static_cast<std::size_t>(k); ++sx) {
                        const std::size_t from =
                            (face * drawn + y * static_cast<std::size_t>(k) + sy) * drawn +
                            x * static_cast<std::size_t>(k) + sx;
                        sum += glm::vec3(impl_->colourPixels[3 * from], impl_->colourPixels[3 * from + 1],
                                         impl_->colourPixels[3 * from + 2]);
                        samples[count++] = impl_->distancePixels[from];
                    }
                }
                map.colour[out] = sum / static_cast<float>(count);
                map.distance[out] = representativeDistance(std::span(samples.data(), count));
            }
        }
    }
    return map;
}

}  // namespace reflection
