#pragma once

#include <memory>
#include <string>
#include <vector>

namespace reflection::gl {

/// While it lives, collects the GL implementation's error messages (KHR_debug, synchronous) of the current
/// context: errors and undefined behaviour only, performance hints not. Tests assert that `errors` is empty;
/// one at a time.
class DebugOutput {
  public:
    DebugOutput();
    ~DebugOutput();
    DebugOutput(const DebugOutput&) = delete;
    DebugOutput& operator=(const DebugOutput&) = delete;

    /// Messages so far, also of glGetError for contexts without debug output.
    std::vector<std::string> errors() const;

  private:
    std::unique_ptr<std::vector<std::string>> errors_;
};

}  // namespace reflection::gl
