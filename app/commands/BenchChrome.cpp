#include <iostream>

#include "app/commands/Benches.h"
#include "app/commands/ChromeBench.h"
#include "app/commands/Version.h"
#include "app/report/Progress.h"
#include "app/report/ResultFile.h"
#include "app/report/Table.h"
#include "reflection/gl/ShaderSource.h"

namespace app {

int benchChrome(const Options& options) {
    ResultFile results("chrome", std::string(programVersion), "");
    const std::filesystem::path file = options.city == Options().city
                                           ? reflection::gl::dataFolder() / "scenes" / "kitchen.json"
                                           : std::filesystem::path(options.city);
    const MirrorWorld world = loadMirrorWorld(file);
    const ChromeStage stage(world);
    Progress progress("chrome", stage.parts.size(), options.quiet);
    ChromeBenchOptions how;
    how.seed = options.seed;
    how.interrupted = [] { return interrupted(); };
    how.advance = [&progress] { progress.advance(); };
    std::vector<std::vector<std::string>> last;
    const auto add = [&](const MirrorRows& part) {
        for (const nlohmann::ordered_json& row : part.rows) results.add(row);
        if (part.table.size() < 2) return;
        if (!last.empty()) std::cout << formatTable(last) << '\n';
        std::cout << part.title << '\n';
        last = part.table;
    };
    add(chromeShares(stage, how));
    return reportBench(options, results, last);
}

}  // namespace app
