#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "app/render/PassTarget.h"
#include "app/render/VehicleGeometry.h"
#include "reflection/gl/LocalMapTextures.h"
#include "reflection/gl/Program.h"
#include "reflection/gl/Texture.h"
#include "vehicles/traffic/VehiclePose.h"

namespace app {

/// Draws vehicles, grouped by mesh and by where they find their reflections, one instanced draw a group.
class VehiclePass {
  public:
    explicit VehiclePass(std::span<const vehicles::VehicleModel> models);

    struct Reflections {
        const reflection::LocalMapTextures* textures = nullptr;
        std::span<const reflection::LocalMapSlot> slots;  ///< one per pose, or empty
        std::uint32_t mirrored = 0;  ///< GL name of a ScreenLight's texture, in place of all maps; 0: none
        /// What chrome shows of close things: see CityChrome. 0: none.
        std::uint32_t closeLight = 0, closeDepth = 0;
        std::span<const std::uint32_t> withChrome;  ///< indices of the poses that it holds, rising
    };
    struct Counts {
        std::uint32_t drawCalls = 0;
        std::uint64_t triangles = 0;
        std::uint32_t vehicles = 0;
    };
    /// `chosen`: indices of the poses to draw. The uniform block Frame must hold the same view.
    Counts draw(const PassView& view, PassTarget target, std::span<const vehicles::VehiclePose> poses,
                std::span<const std::uint32_t> chosen, const Reflections& reflections, float tolerance);

    const VehicleGeometry& geometry() const { return geometry_; }

    /// World box of a pose: upright, wide enough for any heading.
    city::Aabb boundsOf(const vehicles::VehiclePose& pose) const;
    /// Bounding sphere's centre of a pose, relative to an eye.
    glm::vec3 centreOf(const vehicles::VehiclePose& pose, const glm::dvec3& eye) const;

  private:
    /// Where a vehicle finds what it mirrors.
    enum class Mirror : std::uint8_t { plain, map, parallax, screen };
    static reflection::gl::Program programFor(PassTarget target, Mirror mirror, bool chrome);
    struct Piece {
        std::int32_t sizeClass;  ///< -1: plain
        bool chrome;             ///< shows what is close
        std::uint32_t firstIndex;
        MeshRange range;
        VehicleInstance instance;
    };

    VehicleGeometry geometry_;
    reflection::gl::Sampler mapSampler_;
    std::array<std::array<reflection::gl::Program, 4>, 2> programs_;  ///< [target][Mirror]
    std::array<reflection::gl::Program, 4> chromePrograms_;  ///< [Mirror], of views; made when first needed
    std::vector<Piece> pieces_;
    std::vector<std::uint32_t> order_;
    std::vector<VehicleInstance> instances_;
};

}  // namespace app
