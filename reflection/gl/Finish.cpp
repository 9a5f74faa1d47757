#include "reflection/gl/Finish.h"

#include <epoxy/gl.h>

namespace reflection {

void finishGpu() {
    glFinish();
}

}  // namespace reflection
