#include <OpenImageIO/oiioversion.h>
#include <hwy/targets.h>
#include <spdlog/version.h>
#include <CLI/Version.hpp>
#include <glm/detail/setup.hpp>
#include <nlohmann/json.hpp>

#include <iostream>
#include <thread>

#include "app/commands/Commands.h"
#include "app/commands/LoadScene.h"
#include "app/commands/Version.h"
#include "app/display/OffscreenContext.h"
#include "app/display/OffscreenTarget.h"
#include "app/report/ResultFile.h"
#include "app/report/Table.h"

namespace app {

namespace {

using Rows = std::vector<std::pair<std::string, std::string>>;

void print(const std::string& title, const Rows& rows) {
    std::cout << title << "\n";
    for (const auto& [name, value] : rows)
        std::cout << "  " << name << std::string(name.size() < 22 ? 22 - name.size() : 1, ' ') << value
                  << "\n";
}

std::string version(int major, int minor, int patch) {
    return std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(patch);
}

std::string instructionSets() {
    std::string names;
    // The best comes first: the lowest bit.
    for (auto targets = hwy::SupportedTargets(); targets != 0; targets &= targets - 1)
        names += (names.empty() ? "" : " ") + std::string(hwy::TargetName(targets & -targets));
    return names;
}

void printMachine() {
    print("mirrorstreet " + std::string(programVersion),
          {{"processor", processorName()},
           {"threads", std::to_string(std::thread::hardware_concurrency())},
           {"instruction sets", instructionSets()}});
    print("libraries (at compile time)",
          {{"OpenImageIO", OIIO_VERSION_STRING},
           {"GLM", version(GLM_VERSION_MAJOR, GLM_VERSION_MINOR, GLM_VERSION_PATCH)},
           {"nlohmann-json",
            version(NLOHMANN_JSON_VERSION_MAJOR, NLOHMANN_JSON_VERSION_MINOR, NLOHMANN_JSON_VERSION_PATCH)},
           {"CLI11", CLI11_VERSION},
           {"spdlog", version(SPDLOG_VER_MAJOR, SPDLOG_VER_MINOR, SPDLOG_VER_PATCH)}});
    std::cout.flush();
}

void printOpenGl() {
    const OffscreenContext context;
    print("OpenGL",
          {{"renderer", context.renderer()},
           {"version", context.version()},
           {"software", context.software() ? "yes: expect a fraction of a graphics card's speed" : "no"}});
    print("limits", contextLimits());
}

}  // namespace

Command infoCommand() {
    return {.name = "info",
            .summary = "versions, OpenGL renderer and limits; with a CITY, what the city holds",
            .groups = cityOptions | cityIsOptional,
            .benches = {},
            .run = [](const Options& options) {
                if (options.city.empty()) {
                    printMachine();
                    printOpenGl();
                }
                return exitOk;
            }};
}

}  // namespace app
