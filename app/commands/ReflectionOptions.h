#pragma once

#include <CLI/CLI.hpp>

#include "app/commands/Options.h"

namespace app {

/// --budget; with `errorOptions` in the groups --error and --fixed-quality.
void addBudget(CLI::App& parser, Options& options, unsigned groups);
/// --mirrors --weather --mirror-depth --mirror-maps --mirror-fade
void addMirrors(CLI::App& parser, Options& options);
/// --chrome --chrome-share --chrome-bounces
void addChrome(CLI::App& parser, Options& options);

}  // namespace app
