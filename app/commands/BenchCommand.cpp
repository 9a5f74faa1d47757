#include <stdexcept>

#include "app/commands/Benches.h"
#include "app/commands/Commands.h"

namespace app {

namespace {

std::vector<Bench> allBenches() {
    return {
        {{"cars",
          "frame time and error against the number of mirroring cars, every method on the same frames"},
         benchCars},
        {{"localmap", "one local map by every method, against re-rendering its six faces"}, benchLocalMap},
        {{"stills", "a car at 3, 10 and 40 m by every method, as pictures in --out"}, benchStills},
        {{"tracer", "rays per second against heightfields, with an exact check; beside Embree"},
         benchTracer}};
}

}  // namespace

Command benchCommand() {
    std::vector<BenchName> names;
    for (const Bench& bench : allBenches()) names.push_back(bench.name);
    return {.name = "bench",
            .summary = "measurements, as a table and as --json",
            .groups = cityOptions | trafficOptions | reflectionOptions | pictureOptions | durationOptions |
                      jsonOptions | outOptions,
            .benches = names,
            .run = [](const Options& options) {
                for (const Bench& bench : allBenches())
                    if (bench.name.name == options.bench) return bench.run(options);
                throw std::runtime_error("there is no measurement '" + options.bench + "'.");
            }};
}

}  // namespace app
