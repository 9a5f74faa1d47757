#include "app/commands/Program.h"

#include <spdlog/spdlog.h>

#include <iostream>

#include "app/commands/Version.h"
#include "app/report/AsideFile.h"

namespace app {

namespace {

void printUsage(const std::vector<Command>& commands, std::ostream& out) {
    out << "mirrorstreet " << programVersion
        << ": traffic drives through a city, and every moving vehicle mirrors its street.\n\n"
        << "usage: mirrorstreet COMMAND [CITY] [options]\n\n"
        << "CITY is boulevard (default), paper, or a file. Commands:\n";
    for (const Command& command : commands)
        out << "  " << command.name
            << std::string(command.name.size() < 10 ? 10 - command.name.size() : 1, ' ') << command.summary
            << "\n";
    out << "\nmirrorstreet COMMAND --help lists the options of one command; --version prints the version.\n";
}

}  // namespace

int runProgram(const std::vector<Command>& commands, std::span<const std::string> arguments) {
    if (arguments.empty()) {
        printUsage(commands, std::cerr);
        return exitUsage;
    }
    const std::string& name = arguments.front();
    if (name == "--help" || name == "-h" || name == "help") {
        printUsage(commands, std::cout);
        return exitOk;
    }
    if (name == "--version" || name == "version") {
        std::cout << "mirrorstreet " << programVersion << "\n";
        return exitOk;
    }
    std::vector<std::string> names;
    for (const Command& command : commands) {
        names.push_back(command.name);
        if (command.name != name) continue;
        const ParseOutcome outcome = parseOptions(command, arguments.subspan(1));
        if (const int* code = std::get_if<int>(&outcome)) return *code;
        const Options& options = std::get<Options>(outcome);
        if (options.quiet) spdlog::set_level(spdlog::level::warn);
        // Said now rather than after minutes of work.
        for (const auto& file :
             {options.json, options.html, options.exportCity, options.exportCar, options.exportDrive})
            if (file) requireWritable(*file);
        return command.run(options);
    }
    std::cerr << "mirrorstreet: there is no command '" << name << "'";
    if (const auto meant = suggestion(name, names)) std::cerr << "; did you mean '" << *meant << "'?";
    std::cerr << "\nSee mirrorstreet --help.\n";
    return exitUsage;
}

}  // namespace app
