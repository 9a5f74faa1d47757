#pragma once

#include <vector>

#include "app/stability/Stability.h"

namespace app::stability {

/// Drawing at the edges: targets of 1x1 to 16384 pixels a side, every quality, 0 to 100,000 cars. Makes an
/// OpenGL context of its own; throws std::runtime_error where there is none.
std::vector<Row> tryDrawing(const Options& options);

}  // namespace app::stability
