#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <exception>
#include <string>
#include <vector>

#include "app/commands/Commands.h"
#include "app/commands/Program.h"
#include "app/report/Progress.h"

int main(int argc, char** argv) {
    // Results go to stdout; everything else goes to stderr.
    spdlog::set_default_logger(spdlog::stderr_color_mt("mirrorstreet"));
    spdlog::set_pattern("%n: %^%v%$");
    try {
        app::watchForInterrupt();
        return app::runProgram(app::allCommands(), std::vector<std::string>(argv + 1, argv + argc));
    } catch (const std::exception& error) {
        spdlog::error("{}", error.what());
    } catch (...) {
        spdlog::error("an unknown exception ended the program");
    }
    return app::exitFailed;
}
