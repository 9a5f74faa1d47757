#pragma once

#include <array>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "app/render/PassTarget.h"
#include "app/render/VertexFormats.h"
#include "city/model/GlassFronts.h"
#include "reflection/gl/Buffer.h"
#include "reflection/gl/MirrorScene.h"
#include "reflection/gl/Program.h"
#include "reflection/gl/VertexArray.h"

namespace app {

/// Draws a city's panes of glass and its polished stone, over the walls on which they are painted: with a
/// reflection map, blurred where they are rough, or with the mean light of sky and ground in its place.
class GlassPass {
  public:
    explicit GlassPass(std::span<const city::GlassFront> fronts);

    struct Counts {
        std::uint32_t drawCalls = 0;
        std::uint64_t triangles = 0;
    };
    /// What fronts mirror in the present framebuffer.
    struct Mirrored {
        reflection::MirrorMap map;
        glm::mat3 viewFromRelative{1};  ///< of the image in which they are met
        glm::vec2 uvPerTangent{1};      ///< texture coordinates of the map for one unit of x / -z in its view
    };
    /// The uniform block Frame must hold the same view, the city's materials must be bound. Null: mean light.
    /// Indices beyond the fronts are ignored.
    Counts draw(PassTarget target, std::span<const std::uint32_t> fronts, const Mirrored* mirrored);

    /// The fronts that a view sees from their street side, no farther than `reach` metres, but for those that
    /// are marked in `without` (by index; may be shorter).
    void seenBy(const PassView& view, float reach, const std::vector<bool>& without,
                std::vector<std::uint32_t>& seen) const;

    std::size_t size() const { return fronts_.size(); }
    const city::Aabb& boundsOf(std::size_t front) const { return fronts_[front].bounds; }

  private:
    struct Front {
        MeshRange range;
        city::Aabb bounds;
        glm::vec3 normal{1, 0, 0};
        glm::vec3 point{0};
        bool rough = false;
    };
    enum class Image : std::uint8_t { none, sharp, blurred };
    const reflection::gl::Program& programFor(PassTarget target, Image image);
    /// The fronts to draw next; `rough`: only those that are, or are not, so.
    void list(std::span<const std::uint32_t> fronts, const bool* rough, Counts& counts);

    std::vector<Front> fronts_;
    reflection::gl::Buffer vertices_;
    reflection::gl::Buffer indices_;
    reflection::gl::VertexArray array_;
    std::array<std::array<reflection::gl::Program, 3>, 2> programs_;  ///< [target][Image], made when needed
    std::vector<GLsizei> counts_;
    std::vector<const void*> offsets_;
    std::vector<GLint> baseVertices_;
};

}  // namespace app
