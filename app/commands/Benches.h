#pragma once

#include <functional>
#include <vector>

#include "app/commands/Options.h"

namespace app {

/// One measurement of `mirrorstreet bench`: prints a table on stdout, writes `--json`, returns the exit code.
/// A new one is a function like these below and a line in BenchCommand.cpp.
struct Bench {
    BenchName name;
    std::function<int(const Options&)> run;
};

int benchCars(const Options& options);
int benchStills(const Options& options);
int benchTracer(const Options& options);
int benchLocalMap(const Options& options);

}  // namespace app
