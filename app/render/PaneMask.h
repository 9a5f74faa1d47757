#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "city/model/GlassFronts.h"
#include "reflection/gl/Buffer.h"
#include "reflection/gl/Program.h"
#include "reflection/gl/VertexArray.h"
#include "reflection/planar/ReflectionTree.h"

namespace app {

/// What a rectangle (world metres) covers of a node's image, and `texels` around: a convex polygon in
/// normalised device coordinates, counter-clockwise, that may reach a tenth beyond the image. Empty where it
/// covers nothing, lies behind the eye or is not finite. Pure. Cost: some hundred operations.
std::vector<glm::vec2> shownPart(std::span<const glm::dvec3> outline, const reflection::ReflectionNode& node,
                                 double texels);

/// Keeps what is drawn into a smooth front's image to where its panes will look it up. The rectangle around
/// the panes of fronts that share a view and run away from the eye is two to three times as large.
class PaneMask {
  public:
    explicit PaneMask(std::span<const city::GlassFront> fronts);

    /// Before anything is drawn: from now on the depth test (reversed, GL_GEQUAL) fails but where these
    /// fronts' outlines are, and two texels around: one beyond which bilinear lookups do not reach, and one
    /// for the pixels of antialiased edges. The image's viewport and scissor must be set; what lies outside
    /// keeps the colours it had. Changes program, vertex array and face culling. Indices beyond the fronts
    /// are ignored.
    void draw(const reflection::ReflectionNode& node, std::span<const std::uint32_t> fronts);

  private:
    std::vector<std::array<glm::dvec3, 4>> outlines_;
    std::vector<glm::vec2> triangles_;
    reflection::gl::Program program_;
    reflection::gl::Buffer corners_;
    reflection::gl::VertexArray array_;
};

}  // namespace app
