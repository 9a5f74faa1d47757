#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "reflection/reference_maps/ReferenceMap.h"

namespace reflection {

/// A reference map in three bytes a texel, HDR colour and distance together, made for random access by SIMD
/// gathers: no block to decode, no table.
///
///   word    20 bits a texel: nearness in 11 bits (4 exponent, 7 mantissa: 1/8 m .. 8 km within 0.4 %), the
///   sum R+G+B in 9
///           bits (4 exponent, 5 mantissa: 16 octaves below `radianceScale`, within 3.2 %, right on the mean:
///           dithered so that a gradient does not band).
///   chroma  16 bits for each 4x2 texels: R/(R+G+B) and B/(R+G+B) in 8 bits each: the eye resolves colour
///   less
///           finely than brightness.
///
/// Nearness is the reciprocal of the depth along the face's major axis: over a plane it is linear in the face
/// coordinates, so that a bilinear lookup meets facades and streets exactly, however flat they are seen. Sky
/// has the least nearness there is, that of a cube 8192 m around the map: farther than any building, and near
/// enough to need no case of its own.
///
/// Coarser levels down to 16 texels follow the finest (2x2 means), so that a small local map does not alias.
///
/// Every face carries a border of one texel from its neighbours, so that a bilinear lookup never leaves its
/// face. For comparison: 4 bytes in the paper, with 8-bit colour and 8-bit depth.
class PackedReferenceMap {
  public:
    /// One size of the map.
    class Level {
      public:
        Level(const ReferenceMap& map, float radianceScale);
        /// From bytes that `words` and `chroma` gave; their sizes must be those of this face size.
        Level(int faceSize, float radianceScale, std::vector<std::uint8_t> words,
              std::vector<std::uint16_t> chroma);
        static std::size_t wordBytes(int faceSize);    ///< padding included
        static std::size_t chromaCount(int faceSize);  ///< padding included
        int faceSize() const { return faceSize_; }
        const std::uint8_t* words() const { return words_.data(); }
        const std::uint16_t* chroma() const { return chroma_.data(); }
        /// Blocks of chroma in a row of a face; a face has (faceSize + 2) / 2 rows.
        int chromaColumns() const { return (faceSize_ + 2 + 3) / 4; }
        std::size_t bytes() const { return words_.size() + chroma_.size() * sizeof(std::uint16_t); }
        std::size_t texelCount() const {
            return 6 * static_cast<std::size_t>(faceSize_) * static_cast<std::size_t>(faceSize_);
        }

        /// The slow way to one texel, border included: x and y in -1 .. faceSize. Oracle of the SIMD lookup.
        float nearnessAt(int face, int x, int y) const;
        /// Metres from the map's centre, +infinity for sky.
        float distanceAt(int face, int x, int y) const;
        glm::vec3 colourAt(int face, int x, int y) const;

      private:
        std::size_t borderedIndex(int face, int x, int y) const;
        std::size_t chromaIndex(int face, int x, int y) const;
        std::uint32_t wordAt(std::size_t index) const;

        int faceSize_;
        float radianceScale_;
        std::vector<std::uint8_t>
            words_;  ///< 20-bit words, little-endian, packed without gaps, 4 bytes of padding
        std::vector<std::uint16_t> chroma_;  ///< low byte red share, high byte blue share; one of padding
    };

    /// `radianceScale`: greatest R+G+B that can be told apart; greater values are clamped. Face size must be
    /// even and at least 4; negative and NaN colours count as 0. Throws std::invalid_argument otherwise.
    /// Cost: linear in texels.
    PackedReferenceMap(const ReferenceMap& map, float radianceScale);

    /// From levels that were packed before, finest first. Precondition: not empty.
    PackedReferenceMap(const glm::dvec3& position, float radianceScale, std::vector<Level> levels);

    const glm::dvec3& position() const { return position_; }
    float radianceScale() const { return radianceScale_; }
    int faceSize() const { return levels_.front().faceSize(); }
    const std::vector<Level>& levels() const { return levels_; }
    /// The level that a local map of this face size should read: the coarsest with two texels for one of the
    /// local map's, so that a bilinear lookup is about its box filter.
    const Level& levelFor(int localFaceSize) const;

    std::size_t bytes() const;
    std::size_t texelCount() const;  ///< all levels

    static constexpr std::uint32_t nearnessBits = 11;
    static constexpr std::uint32_t nearnessMask = (1u << nearnessBits) - 1;
    /// Exponent bias of the least nearness, 2^-13 per metre.
    static constexpr std::uint32_t nearnessExponentBias = 127 - 13;
    static constexpr std::uint32_t sumMantissaShift = 18;  ///< keeps 5 of 23 mantissa bits
    static constexpr std::uint32_t sumExponentBias = 127 - 16;
    /// Depth along the major axis that stands for the sky, metres.
    static constexpr float skyDepth = 8192;

  private:
    glm::dvec3 position_;
    float radianceScale_;
    std::vector<Level> levels_;
};

}  // namespace reflection
