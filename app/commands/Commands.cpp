#include "app/commands/Commands.h"

namespace app {

std::vector<Command> allCommands() {
    return {tourCommand(),   bakeCommand(), benchCommand(),     compareCommand(),
            exportCommand(), infoCommand(), stabilityCommand(), truthCommand()};
}

}  // namespace app
