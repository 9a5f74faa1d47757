#pragma once

#include <span>
#include <string>
#include <vector>

#include "app/commands/Options.h"

namespace app {

/// The whole program behind main(): finds the command, parses, runs it. Returns the exit code; lets
/// exceptions of the command pass.
int runProgram(const std::vector<Command>& commands, std::span<const std::string> arguments);

}  // namespace app
