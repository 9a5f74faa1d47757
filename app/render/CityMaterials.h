#pragma once

#include <vector>

#include "city/model/Material.h"
#include "reflection/gl/Buffer.h"
#include "reflection/gl/Texture.h"

namespace app {

/// The city's materials on the GPU: every pattern's picture with mipmaps in one texture array, and the table
/// of tints.
class CityMaterials {
  public:
    static constexpr std::size_t capacity = 1024;

    /// Throws std::runtime_error when there are more than `capacity` materials.
    explicit CityMaterials(const std::vector<city::Material>& materials);

    /// Patterns to texture unit 0, table to uniform buffer 1.
    void bind() const;

  private:
    reflection::gl::Texture patterns_;
    reflection::gl::Buffer table_;
};

}  // namespace app
