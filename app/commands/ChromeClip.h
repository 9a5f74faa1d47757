#pragma once

#include <glm/vec2.hpp>

#include "app/commands/DetailBench.h"
#include "app/commands/LoadScene.h"

namespace app {

struct CloseScene;

/// A clip like this one, but seen from near a vehicle's largest piece of whole chrome, which drives on with
/// another vehicle beside it: chrome as large and things as close to it as they get. Empty where no vehicle
/// of the clip has such chrome, or there is one alone.
DetailBench::Clip chromeClip(const Scene& scene, const CloseScene& close, const DetailBench::Clip& like,
                             glm::ivec2 resolution);

}  // namespace app
