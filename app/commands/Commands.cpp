#include "app/commands/Commands.h"

namespace app {

std::vector<Command> allCommands() {
    return {tourCommand(), exportCommand(), infoCommand()};
}

}  // namespace app
