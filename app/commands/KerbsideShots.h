#pragma once

#include <glm/vec2.hpp>
#include <span>
#include <string>
#include <vector>

#include "app/commands/LoadScene.h"
#include "app/frame/ChromeParts.h"
#include "app/frame/FrameScene.h"

namespace app {

/// A look at a piece of chrome of a staged vehicle, at the moment at which another one passes it.
struct KerbsideShot {
    std::string name;
    FrameScene frame;           ///< with this one view
    std::uint32_t vehicle = 0;  ///< whose chrome it is: index into the frame's vehicles
    double seconds = 0;         ///< after the staged vehicles' start
    double pixels = 0;          ///< the part's width on screen
    double away = 0;            ///< metres from the eye to it
    double apart = 0;           ///< metres from the part's middle to the nearest that moves; 0: nothing does
};

/// The views of a staging file in which a staged vehicle's chrome is large enough to show close things. The
/// moment: of the first `seconds`, that at which a staged vehicle that moves is nearest to the part, in the
/// picture itself, without hiding any of the part from the eye. `frame`: without views. Deterministic.
std::vector<KerbsideShot> kerbsideShots(const Scene& scene, const ChromeParts& parts, const FrameScene& frame,
                                        glm::ivec2 resolution, double seconds);

/// The frame's staged vehicles where they are so many seconds after their start.
void moveStaged(FrameScene& frame, const Scene& scene, double seconds);

}  // namespace app
