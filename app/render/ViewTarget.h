#pragma once

#include <cstdint>
#include <glm/vec2.hpp>

#include "app/render/Dissolve.h"
#include "app/render/SceneRenderer.h"
#include "reflection/gl/Buffer.h"
#include "reflection/gl/Framebuffer.h"
#include "reflection/gl/Program.h"
#include "reflection/gl/Texture.h"
#include "reflection/gl/VertexArray.h"

namespace app {

/// What a view is drawn into before it is antialiased and handed on: colour (RGBA8, display values) and
/// depth. A change of detail can be hidden in a view that stands: see `dissolve`.
class ViewTarget {
  public:
    explicit ViewTarget(Antialiasing antialiasing);

    /// Makes the target current with depth cleared, at a size; allocates when the size changed. Of it, the
    /// share `scale` a side (0..1) is drawn, one pixel at least: see `drawn`.
    void begin(glm::ivec2 size, double scale = 1);
    /// Pixels drawn since the last `begin`.
    glm::ivec2 drawn() const { return drawn_; }
    /// GL name of the framebuffer that is drawn into between `begin` and `finish`.
    std::uint32_t framebuffer() const { return target_.name(); }
    /// Antialiases into the caller's framebuffer, stretched to the view's size; it is current afterwards.
    /// `antialiasing`: see DrawingDetail.
    void finish(std::uint32_t framebuffer, double antialiasing = 1);

    /// From the picture that was finished last, whatever its size and antialiasing, the next ones take over
    /// in parts, in so many frames. Before `begin`. Nothing where none of this size was finished before.
    /// Costs a copy of a picture now, and much less than one in each of the frames.
    void dissolve(int frames);
    /// Makes now what the first call of `dissolve` and a first smaller picture would wait for: some
    /// milliseconds, tens where OpenGL is software.
    void prepareDissolving(glm::ivec2 size);
    bool dissolving() const { return dissolve_.active(); }
    /// Pixels that show the next pictures already: see Dissolve.
    void keepLive(std::uint64_t name, const glm::ivec4& pixels, int frames = 1) {
        dissolve_.keepLive(name, pixels, frames);
    }
    /// The next picture is shown whole.
    void endDissolving() { dissolve_.stop(); }

  private:
    void allocate(glm::ivec2 size);
    void allocateShown();
    /// In so many rows of pixels, the middle ones.
    void mendEdges(int rows);
    /// One sample a pixel, without edges mended.
    void makeSmooth(bool withDepth, const char* purpose);
    /// Of what was drawn into an image, stretched to the view's size.
    void copyParts(const reflection::gl::Texture& image, std::uint32_t framebuffer,
                   std::span<const glm::ivec4> parts);

    Antialiasing antialiasing_;
    glm::ivec2 size_{0};
    glm::ivec2 drawn_{0};
    reflection::gl::Texture colour_;
    reflection::gl::Texture depth_;
    reflection::gl::Framebuffer target_;
    reflection::gl::Texture smooth_;  ///< fxaa: the image with its edges mended; msaa: with one sample,
                                      ///< to be stretched
    reflection::gl::Framebuffer smoothTarget_;
    reflection::gl::Program findEdges_;
    reflection::gl::Program fxaa_;
    reflection::gl::VertexArray nothing_;

    bool finishedSmooth_ = false;
    std::uint32_t finished_ = 0;  ///< framebuffer that holds the last picture, before it was stretched
    Dissolve dissolve_;
    reflection::gl::Texture shown_;  ///< while dissolving: what is shown
    reflection::gl::Framebuffer shownTarget_;
    reflection::gl::Program tiles_;
    reflection::gl::Buffer rectangles_;
    reflection::gl::VertexArray rectangleArray_;
};

}  // namespace app
