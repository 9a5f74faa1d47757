#pragma once

#include <string>

namespace app {

/// GL_RENDERER, GL_VERSION and the like of the current context; empty without one.
std::string glText(unsigned name);

/// Several lines about the current context: renderer, vendor, version, shading language, limits that matter
/// here. Empty without one.
std::string glInfo();

/// Whether a GL_RENDERER names a rasteriser that runs on the CPU.
bool isSoftwareRenderer(const std::string& renderer);

}  // namespace app
