#pragma once

#include <string>
#include <vector>

#include "app/commands/PreparedScene.h"
#include "app/frame/FrameScene.h"
#include "app/report/ResultFile.h"

namespace app {

struct CloseScene;

/// Frames of `mem` in which chrome shows close things beside frames in which it does not, in turn, and what
/// one map drawn anew takes for the same vehicle (`reflector`: index into the frame's): an eye that sways by
/// 20 cm from `view`, one that stands, and one that looks the other way. Rows for the results and for
/// BenchSquare's table, named `name`.
void measureChromeCost(const Options& options, PreparedScene& stage, const CloseScene& close,
                       const std::string& name, const View& from, FrameScene frame, std::uint32_t reflector,
                       ResultFile& results, std::vector<std::vector<std::string>>& table);

}  // namespace app
