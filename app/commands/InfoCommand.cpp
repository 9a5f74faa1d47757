#include <hwy/targets.h>
#include <spdlog/version.h>
#include <CLI/Version.hpp>
#include <glm/glm.hpp>
#include <iostream>
#include <thread>

#include "app/commands/Commands.h"
#include "app/commands/Version.h"

namespace app {

namespace {

void printProgram() {
    std::cout << "mirrorstreet " << programVersion << "\n";
    std::cout << "threads        " << std::thread::hardware_concurrency() << "\n";
    std::cout << "SIMD           ";
    for (int64_t targets = hwy::SupportedTargets(); targets != 0; targets &= targets - 1)
        std::cout << hwy::TargetName(targets & -targets) << " ";
    std::cout << "\n";
}

int run(const Options&) {
    printProgram();
    return exitOk;
}

}  // namespace

Command infoCommand() {
    return {.name = "info",
            .summary = "versions, OpenGL renderer and limits; with a CITY, what the city holds",
            .groups = cityOptions | cityIsOptional,
            .benches = {},
            .run = run};
}

}  // namespace app
