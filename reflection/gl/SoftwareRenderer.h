#pragma once

namespace reflection {

/// Whether the current context's rasteriser runs on the processor (llvmpipe, softpipe, swrast, SWR): what a
/// graphics card does better than the processor is then better done by the processor's own instructions.
bool softwareRenderer();

}  // namespace reflection
