#pragma once

#include "app/commands/LoadScene.h"

namespace app {

/// The tour without a window: stills and a video in `--out`, a table of times on stdout. Returns the exit
/// code; throws std::runtime_error when OpenGL or the files cannot be had. An interrupt ends it early with
/// everything so far in place.
int runOffscreenTour(const Options& options);

}  // namespace app
