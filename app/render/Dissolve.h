#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <map>
#include <span>
#include <vector>

namespace app {

/// In which order the parts of a standing picture are replaced by those of a new one, so that nobody sees it
/// change: small tiles, scattered, the same number every frame. Where something moves the new picture comes
/// much sooner, and is shown in every frame then; but there as well by tiles: what moves would change as a
/// whole in one frame otherwise, which was measured to be seen two to four times as well as the motion.
///
/// A share of a change, and not a weakened change: twice as many frames halve what each of them shows, while
/// a cross-fade of sharp edges is seen by its weakest step already.
class Dissolve {
  public:
    /// A square's side, pixels.
    static constexpr int tile = 16;

    /// All of a picture of this size is old, and new after so many frames (1 at least). Anew where one was
    /// going on already: what has moved until now is part of the old picture.
    void start(glm::ivec2 size, int frames);
    void stop() { frame_ = frames_ = 0; }
    bool active() const { return frame_ < frames_; }

    /// Pixels x0 y0 .. x1 y1 (these not included) show the new picture from now on: where something that
    /// moves, of this name, is and has been; of what is named for the first time, all tiles within so many
    /// frames. Outside of the picture there is nothing to do.
    void keepLive(std::uint64_t name, const glm::ivec4& pixels, int frames = 1);

    /// The next frame's rectangles, x0 y0 x1 y1, to be replaced: all of them together have covered the
    /// picture when `active` ends. Precondition: active.
    std::span<const glm::ivec4> advance();

  private:
    glm::ivec2 size_{0}, tiles_{0};
    int frame_ = 0, frames_ = 0;
    std::uint64_t replaced_ = 0;  ///< of the tiles in their order
    struct Live {
        glm::ivec4 pixels;
        int frames = 1, frame = 0;
    };
    void addLive(const Live& live);

    std::map<std::uint64_t, Live> live_;
    std::vector<std::uint8_t> now_;  ///< by tile
    std::vector<glm::ivec4> rectangles_;
};

}  // namespace app
