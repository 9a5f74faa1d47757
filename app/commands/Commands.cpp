#include "app/commands/Commands.h"

namespace app {

std::vector<Command> allCommands() {
    return {tourCommand(), bakeCommand(),      benchCommand(), exportCommand(),
            infoCommand(), stabilityCommand(), truthCommand()};
}

}  // namespace app
