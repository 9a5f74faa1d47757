#pragma once

#include <functional>
#include <string>
#include <vector>

#include "app/commands/Options.h"
#include "app/report/ResultFile.h"

namespace app {

/// One measurement of `mirrorstreet bench`: prints a table on stdout, writes `--json`, returns the exit code.
/// A new one is a function like these below and a line in BenchCommand.cpp.
struct Bench {
    BenchName name;
    std::function<int(const Options&)> run;
};

/// The end of every measurement: prints the table (its first row is the head), writes `--json`, marked as
/// partial after an interrupt, says so, and returns the exit code: failed too where nothing was measured.
int reportBench(const Options& options, const ResultFile& results,
                const std::vector<std::vector<std::string>>& table);

int benchCars(const Options& options);
int benchChrome(const Options& options);
int benchEmpty(const Options& options);
int benchGovernor(const Options& options);
int benchSquare(const Options& options);
int benchStills(const Options& options);
int benchStreets(const Options& options);
int benchWindows(const Options& options);
int benchTracer(const Options& options);
int benchKerbside(const Options& options);
int benchLocalMap(const Options& options);
int benchMirrors(const Options& options);

}  // namespace app
