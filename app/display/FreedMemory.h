#pragma once

#include <string_view>

namespace app {

/// Where OpenGL is llvmpipe, of Mesa: memory that is freed stays with the process, up to 256 MiB of it,
/// instead of going back to the system. llvmpipe takes and frees some 64 KiB for each change of target and
/// each tile with something in it, and pages that come anew cost more than what is written there: a frame of
/// thirty mirrors took a quarter longer, with 1,000 page faults in place of 60. `renderer`: GL_RENDERER.
/// Returns whether something was done: false for other drivers and C libraries other than GNU's.
bool keepFreedMemory(std::string_view renderer);

}  // namespace app
