#include "app/display/FreedMemory.h"

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace app {

bool keepFreedMemory(std::string_view renderer) {
    if (renderer.find("llvmpipe") == std::string_view::npos) return false;
#ifdef __GLIBC__
    // What is larger than the second goes back at once, as before; it is the most that glibc takes.
    return mallopt(M_TRIM_THRESHOLD, 256 << 20) == 1 && mallopt(M_MMAP_THRESHOLD, 32 << 20) == 1;
#else
    return false;
#endif
}

}  // namespace app
