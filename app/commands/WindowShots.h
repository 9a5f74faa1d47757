#pragma once

#include <optional>

#include "app/commands/LoadScene.h"
#include "app/frame/FrameScene.h"
#include "reflection/truth/TriangleTracer.h"

namespace app {

/// A car and a shop window that shows it.
struct WindowShot {
    View view;
    std::uint32_t vehicle = 0;  ///< index into FrameScene::vehicles
    std::uint32_t front = 0;    ///< of Scene::glass
};

/// The view from across the street in which a window shows a car best: nothing of the city in the way from
/// the eye to the glass, from the glass to the car, nor from the eye to the car. Nothing where no car drives
/// past a window. Cost: cars times fronts near them, a few rays each.
std::optional<WindowShot> carInWindow(const Scene& scene, const FrameScene& frame,
                                      const reflection::TriangleTracer& triangles, glm::ivec2 size);

}  // namespace app
