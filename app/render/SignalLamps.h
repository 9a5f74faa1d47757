#pragma once

#include <array>
#include <glm/vec4.hpp>
#include <span>
#include <vector>

#include "app/render/PassTarget.h"
#include "city/model/CityModel.h"
#include "reflection/gl/Buffer.h"
#include "reflection/gl/Program.h"
#include "reflection/gl/VertexArray.h"
#include "vehicles/traffic/Traffic.h"

namespace app {

/// The lit lamps of signal heads: red above, amber in the middle, green below.
class SignalLamps {
  public:
    explicit SignalLamps(std::vector<city::SignalHead> heads);
    /// Heads without a colour stay dark. Returns the number of draw calls.
    std::uint32_t draw(const PassView& view, PassTarget target,
                       std::span<const vehicles::SignalColour> colours);

  private:
    struct Instance {
        glm::vec4 place;
        glm::vec4 facing;
        glm::vec4 colour;
    };
    std::vector<city::SignalHead> heads_;
    std::array<reflection::gl::Program, 2> programs_;
    reflection::gl::Buffer buffer_;
    reflection::gl::VertexArray array_;
    std::vector<Instance> instances_;
};

}  // namespace app
