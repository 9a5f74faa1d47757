#pragma once

#include "app/commands/LoadScene.h"

namespace app {

/// The tour in a window, until it is closed (or for the length that --seconds or --frames ask for): keys,
/// mouse and panel. Prints a table of times on stdout at the end. Returns the exit code; throws
/// std::runtime_error when there is no display or no OpenGL 4.5.
int runWindowTour(const Options& options);

}  // namespace app
