#pragma once

#include <cstddef>

namespace app {

/// Where OpenGL is llvmpipe, of Mesa: each of its threads gets a processor core of its own to stay on, of
/// those that the process may use, if there are no more threads than cores. Returns how many did. Left alone,
/// Linux now and then wakes two of them on one core, and a frame takes up to twice its time: measured on two
/// cores, in 5% of frames instead of 1 to 2%. Other threads are left as they are.
/// Elsewhere nothing is done. Call once a context is current.
std::size_t spreadRasteriserThreads();

}  // namespace app
