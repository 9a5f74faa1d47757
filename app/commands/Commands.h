#pragma once

#include <vector>

#include "app/commands/Options.h"

namespace app {

Command tourCommand();
Command bakeCommand();
Command benchCommand();
Command compareCommand();
Command exportCommand();
Command infoCommand();
Command truthCommand();
Command stabilityCommand();

/// Every command of the program, in the order in which --help lists them.
std::vector<Command> allCommands();

}  // namespace app
