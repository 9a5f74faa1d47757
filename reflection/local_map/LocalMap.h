#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace reflection {

/// A vehicle's own environment map in memory: linear RGB radiance and the ray parameter of what is seen, one
/// plane each, faces in CubeMapping's order.
struct LocalMap {
    int faceSize = 0;
    std::vector<float> red, green, blue;  ///< 6 * faceSize^2
    std::vector<float> depth;  ///< along the texel's cube direction (greatest component 1), +infinity: sky

    void resize(int size) {
        faceSize = size;
        const std::size_t texels = 6 * static_cast<std::size_t>(size) * static_cast<std::size_t>(size);
        red.resize(texels);
        green.resize(texels);
        blue.resize(texels);
        depth.resize(texels);
    }
    std::size_t faceOffset(int face) const {
        return static_cast<std::size_t>(face) * static_cast<std::size_t>(faceSize) *
               static_cast<std::size_t>(faceSize);
    }
};

}  // namespace reflection
