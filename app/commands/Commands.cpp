#include "app/commands/Commands.h"

namespace app {

std::vector<Command> allCommands() {
    return {infoCommand()};
}

}  // namespace app
