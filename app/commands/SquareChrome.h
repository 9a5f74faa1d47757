#pragma once

#include <string>
#include <vector>

#include "app/commands/PreparedScene.h"
#include "app/commands/SquareShots.h"
#include "app/report/ResultFile.h"

namespace app {

struct CloseScene;

/// Frames of `mem` in which chrome shows close things beside frames in which it does not, in turn, and what
/// one map drawn anew takes for the same reflector: an eye that moves by a reflector with a car beside it,
/// one that stands, and one that looks the other way. Rows for the results and for BenchSquare's table.
void measureChromeCost(const Options& options, PreparedScene& stage, const CloseScene& close,
                       const SquareShot& shot, FrameScene frame, ResultFile& results,
                       std::vector<std::vector<std::string>>& table);

}  // namespace app
