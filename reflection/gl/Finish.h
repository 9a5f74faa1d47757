#pragma once

namespace reflection {

/// Waits until all GL commands issued so far have run: for measuring.
void finishGpu();

}  // namespace reflection
