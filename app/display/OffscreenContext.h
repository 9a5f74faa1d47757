#pragma once

#include <memory>
#include <string>

namespace app {

/// An OpenGL 4.5 core context without a window (EGL, surfaceless platform first, then any device). Current
/// from construction to destruction on the constructing thread. Throws std::runtime_error naming what is
/// missing and what to install.
class OffscreenContext {
  public:
    OffscreenContext();
    ~OffscreenContext();
    OffscreenContext(const OffscreenContext&) = delete;
    OffscreenContext& operator=(const OffscreenContext&) = delete;

    const std::string& renderer() const;  ///< GL_RENDERER
    const std::string& version() const;   ///< GL_VERSION
    bool software() const;                ///< true for llvmpipe, softpipe and the like

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace app
