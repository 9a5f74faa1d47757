#pragma once

#include <glm/vec2.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/commands/LoadScene.h"
#include "app/frame/FrameScene.h"
#include "app/frame/View.h"
#include "app/raytrace/RayTracer.h"

namespace app {

/// A look along a front of polished stone and frosted glass, from the pavement: the one, of the largest, that
/// shows most of both. Nothing for a city without any, or where nothing of them can be seen. `rays` must be
/// prepared with the frame.
std::optional<View> stoneShot(const Scene& scene, const RayTracer& rays, glm::ivec2 resolution);

}  // namespace app
