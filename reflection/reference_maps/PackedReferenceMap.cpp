#include "reflection/reference_maps/PackedReferenceMap.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <stdexcept>
#include <utility>

#include "reflection/reference_maps/CubeMapping.h"

namespace reflection {

namespace {

constexpr std::uint32_t sumMantissaShift = PackedReferenceMap::sumMantissaShift;
constexpr std::uint32_t sumExponentBias = PackedReferenceMap::sumExponentBias;
constexpr std::uint32_t greatestSum = (1u << 9) - 1;

/// Integer hash (finaliser of MurmurHash3): the dither must be the same on every machine.
std::uint32_t scramble(std::uint32_t x) {
    x ^= x >> 16;
    x *= 0x85ebca6bu;
    x ^= x >> 13;
    x *= 0xc2b2ae35u;
    return x ^ (x >> 16);
}

std::uint32_t encodeSum(float relative, std::uint32_t dither) {
    const std::uint32_t lowest = sumExponentBias << 23;
    const std::uint32_t bits = std::bit_cast<std::uint32_t>(relative);
    if (!(relative > 0) || bits <= lowest) return 0;
    return std::min(greatestSum,
                    (bits - lowest + (dither & ((1u << sumMantissaShift) - 1))) >> sumMantissaShift);
}

float decodeSum(std::uint32_t code) {
    return std::bit_cast<float>((code << sumMantissaShift) + (sumExponentBias << 23));
}

/// Rounded to the nearest code; zero and NaN are the least.
std::uint32_t encodeNearness(float nearness) {
    constexpr std::uint32_t lowest = PackedReferenceMap::nearnessExponentBias << 23;
    const std::uint32_t bits = std::bit_cast<std::uint32_t>(nearness);
    if (!(nearness > 0) || bits <= lowest) return 0;
    return std::min(PackedReferenceMap::nearnessMask, (bits - lowest + 0x8000u) >> 16);
}

/// Small enough for the sums of a block of colours, and 255 times them, to stay finite.
constexpr float greatestColour = 1e30f;

float finiteOrZero(float x) {
    return x > 0 ? std::min(x, greatestColour) : 0.0f;
}

}  // namespace

PackedReferenceMap::PackedReferenceMap(const ReferenceMap& map, float radianceScale)
    : position_(map.position), radianceScale_(radianceScale) {
    if (map.faceSize < 4 || map.faceSize % 2 != 0)
        throw std::invalid_argument("a reference map's face size must be even and at least 4");
    if (!(radianceScale > 0) || !std::isfinite(radianceScale))
        throw std::invalid_argument("a reference map's radiance scale must be finite and positive");
    if (map.colour.size() != map.texelCount() || map.distance.size() != map.texelCount())
        throw std::invalid_argument("a reference map must have six full faces of colour and distance");
    levels_.emplace_back(map, radianceScale);
    constexpr int coarsest = 16;
    ReferenceMap coarse = map;
    while (coarse.faceSize % 4 == 0 && coarse.faceSize / 2 >= coarsest) {
        coarse = halved(coarse);
        levels_.emplace_back(coarse, radianceScale);
    }
}

PackedReferenceMap::PackedReferenceMap(const glm::dvec3& position, float radianceScale,
                                       std::vector<Level> levels)
    : position_(position), radianceScale_(radianceScale), levels_(std::move(levels)) {}

PackedReferenceMap::Level::Level(int faceSize, float radianceScale, std::vector<std::uint8_t> words,
                                 std::vector<std::uint16_t> chroma)
    : faceSize_(faceSize),
      radianceScale_(radianceScale),
      words_(std::move(words)),
      chroma_(std::move(chroma)) {}

std::size_t PackedReferenceMap::Level::wordBytes(int faceSize) {
    const std::size_t m = static_cast<std::size_t>(faceSize) + 2;
    return (6 * m * m * 5 + 1) / 2 + 4;
}

std::size_t PackedReferenceMap::Level::chromaCount(int faceSize) {
    return 6 * static_cast<std::size_t>((faceSize + 2 + 3) / 4) *
               static_cast<std::size_t>((faceSize + 2) / 2) +
           1;
}

const PackedReferenceMap::Level& PackedReferenceMap::levelFor(int localFaceSize) const {
    std::size_t level = 0;
    while (level + 1 < levels_.size() && levels_[level + 1].faceSize() >= 2 * localFaceSize) ++level;
    return levels_[level];
}

std::size_t PackedReferenceMap::bytes() const {
    std::size_t total = 0;
    for (const Level& level : levels_) total += level.bytes();
    return total;
}

std::size_t PackedReferenceMap::texelCount() const {
    std::size_t total = 0;
    for (const Level& level : levels_) total += level.texelCount();
    return total;
}

PackedReferenceMap::Level::Level(const ReferenceMap& map, float radianceScale)
    : faceSize_(map.faceSize), radianceScale_(radianceScale) {
    const int n = faceSize_;
    const int m = n + 2;
    words_.assign(wordBytes(n), 0);
    chroma_.assign(chromaCount(n), 0);

    // Where a bordered texel takes its content from: its own face, or across an edge the texel that its
    // direction meets.
    const auto source = [&](int face, int x, int y) {
        if (x < 0 || y < 0 || x >= n || y >= n) {
            const CubePoint p = cubePoint(cubeDirection(face, glm::vec2(x, y) + 0.5f, n));
            const auto texel = [n](float st) {
                return std::clamp(static_cast<int>((st * 0.5f + 0.5f) * static_cast<float>(n)), 0, n - 1);
            };
            face = p.face;
            x = texel(p.st.x);
            y = texel(p.st.y);
        }
        return (static_cast<std::size_t>(face) * static_cast<std::size_t>(n) + static_cast<std::size_t>(y)) *
                   static_cast<std::size_t>(n) +
               static_cast<std::size_t>(x);
    };

    const auto directionLength = [n](int x, int y) {
        return glm::length(cubeDirection(0, glm::vec2(x, y) + 0.5f, n));
    };

    for (int face = 0; face < 6; ++face) {
        for (int by = 0; by < m / 2; ++by) {
            for (int bx = 0; bx < chromaColumns(); ++bx) {
                float red = 0, blue = 0, all = 0;
                for (int k = 0; k < 8; ++k) {
                    const int x = 4 * bx + (k & 3) - 1;
                    const int y = 2 * by + (k >> 2) - 1;
                    if (x > n) continue;
                    const std::size_t from = source(face, x, y);
                    const glm::vec3 c(finiteOrZero(map.colour[from].r), finiteOrZero(map.colour[from].g),
                                      finiteOrZero(map.colour[from].b));
                    const float sum = c.r + c.g + c.b;
                    red += c.r;
                    blue += c.b;
                    all += sum;

                    const std::size_t index = borderedIndex(face, x, y);
                    const std::uint32_t word =
                        (encodeSum(sum / radianceScale, scramble(static_cast<std::uint32_t>(index)))
                         << nearnessBits) |
                        encodeNearness(directionLength(x, y) / map.distance[from]);
                    const std::size_t byte = index * 5 / 2;
                    if (index % 2 == 0) {
                        words_[byte] = static_cast<std::uint8_t>(word);
                        words_[byte + 1] = static_cast<std::uint8_t>(word >> 8);
                        words_[byte + 2] =
                            static_cast<std::uint8_t>((words_[byte + 2] & 0xf0u) | (word >> 16));
                    } else {
                        words_[byte] =
                            static_cast<std::uint8_t>((words_[byte] & 0x0fu) | ((word & 0xfu) << 4));
                        words_[byte + 1] = static_cast<std::uint8_t>(word >> 4);
                        words_[byte + 2] = static_cast<std::uint8_t>(word >> 12);
                    }
                }
                const auto share = [all](float part) {
                    return all > 0 ? static_cast<std::uint32_t>(std::lround(255.0f * part / all)) : 85u;
                };
                chroma_[chromaIndex(face, 4 * bx - 1, 2 * by - 1)] =
                    static_cast<std::uint16_t>(share(red) | (share(blue) << 8));
            }
        }
    }
}

std::size_t PackedReferenceMap::Level::borderedIndex(int face, int x, int y) const {
    const std::size_t m = static_cast<std::size_t>(faceSize_) + 2;
    return (static_cast<std::size_t>(face) * m + static_cast<std::size_t>(y + 1)) * m +
           static_cast<std::size_t>(x + 1);
}

std::size_t PackedReferenceMap::Level::chromaIndex(int face, int x, int y) const {
    const auto rows = static_cast<std::size_t>(faceSize_ + 2) / 2;
    return (static_cast<std::size_t>(face) * rows + static_cast<std::size_t>((y + 1) / 2)) *
               static_cast<std::size_t>(chromaColumns()) +
           static_cast<std::size_t>((x + 1) / 4);
}

std::uint32_t PackedReferenceMap::Level::wordAt(std::size_t index) const {
    const std::size_t byte = index * 5 / 2;
    const std::uint32_t three = words_[byte] | (static_cast<std::uint32_t>(words_[byte + 1]) << 8) |
                                (static_cast<std::uint32_t>(words_[byte + 2]) << 16);
    return (three >> (index % 2 == 0 ? 0 : 4)) & 0xfffffu;
}

float PackedReferenceMap::Level::nearnessAt(int face, int x, int y) const {
    return std::bit_cast<float>(((wordAt(borderedIndex(face, x, y)) & nearnessMask) << 16) +
                                (nearnessExponentBias << 23));
}

float PackedReferenceMap::Level::distanceAt(int face, int x, int y) const {
    const float nearness = nearnessAt(face, x, y);
    if (nearness <= 1 / skyDepth) return std::numeric_limits<float>::infinity();
    return glm::length(cubeDirection(face, glm::vec2(x, y) + 0.5f, faceSize_)) / nearness;
}

glm::vec3 PackedReferenceMap::Level::colourAt(int face, int x, int y) const {
    const float sum = radianceScale_ * decodeSum(wordAt(borderedIndex(face, x, y)) >> nearnessBits);
    const std::uint16_t shares = chroma_[chromaIndex(face, x, y)];
    const float red = sum * static_cast<float>(shares & 0xff) / 255.0f;
    const float blue = sum * static_cast<float>(shares >> 8) / 255.0f;
    return {red, std::max(0.0f, sum - red - blue), blue};
}

}  // namespace reflection
