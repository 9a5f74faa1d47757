#include "app/commands/MirrorMask.h"

#include <algorithm>
#include <cmath>

#include "reflection/local_map/PackedMips.h"

namespace app {

namespace {

/// The smallest maps there are: one black, one white.
constexpr auto sizeClass = static_cast<std::int16_t>(reflection::localMapFaceSizes.size() - 1);

}  // namespace

MirrorMask::MirrorMask() {
    reflection::LocalMap map;
    map.resize(reflection::localMapFaceSizes.back());
    atlas_.reserve(sizeClass, 2);
    for (std::int16_t shade = 0; shade < 2; ++shade) {
        for (std::vector<float>* plane : {&map.red, &map.green, &map.blue})
            std::fill(plane->begin(), plane->end(), 4.0f * static_cast<float>(shade));
        reflection::PackedMips mips;
        reflection::packMips(map, mips);
        atlas_.upload({sizeClass, shade}, mips);
    }
}

std::vector<unsigned char> MirrorMask::of(SceneRenderer& renderer, const FrameScene& scene,
                                          const OffscreenTarget& target) {
    Image8 images[2];
    for (std::int16_t shade = 0; shade < 2; ++shade) {
        VehicleReflections reflections;
        reflections.textures = atlas_.textures();
        reflections.slots.assign(scene.vehicles.size(), {sizeClass, shade});
        renderer.drawView(scene.views.front(), reflections, target.framebuffer());
        images[shade] = readPixels(target.framebuffer(), target.size());
    }
    std::vector<unsigned char> mask(images[0].rgba.size() / 4);
    for (std::size_t i = 0; i < mask.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c)
            if (images[0].rgba[4 * i + c] != images[1].rgba[4 * i + c]) mask[i] = 1;
    return mask;
}

std::vector<glm::vec3> toFloat(const Image8& image) {
    std::vector<glm::vec3> pixels(image.rgba.size() / 4);
    for (std::size_t i = 0; i < pixels.size(); ++i)
        pixels[i] = glm::vec3(image.rgba[4 * i], image.rgba[4 * i + 1], image.rgba[4 * i + 2]) / 255.0f;
    return pixels;
}

Image8 toImage(const std::vector<glm::vec3>& pixels, glm::ivec2 size) {
    Image8 image{size, {}};
    image.rgba.reserve(4 * pixels.size());
    for (const glm::vec3& p : pixels) {
        for (int c = 0; c < 3; ++c)
            image.rgba.push_back(static_cast<std::uint8_t>(std::lround(255 * std::clamp(p[c], 0.0f, 1.0f))));
        image.rgba.push_back(255);
    }
    return image;
}

}  // namespace app
