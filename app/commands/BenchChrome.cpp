#include <iostream>
#include <stdexcept>

#include "app/commands/Benches.h"
#include "app/commands/ChromeBench.h"
#include "app/commands/Version.h"
#include "app/display/OffscreenContext.h"
#include "app/report/Progress.h"
#include "app/report/ResultFile.h"
#include "app/report/Table.h"
#include "reflection/gl/ShaderSource.h"

namespace app {

namespace {

MirrorWorld namedWorld(const char* file) {
    return loadMirrorWorld(reflection::gl::dataFolder() / "scenes" / file);
}

MirrorWorld chromeWorld(const Options& options) {
    if (options.city == Options().city) return namedWorld("kitchen.json");
    if (!options.city.ends_with(".json"))
        throw std::runtime_error(
            "'" + options.city +
            "': chrome is measured in scenes of its own; name a scene FILE.json, or nothing.");
    MirrorWorld world = loadMirrorWorld(options.city);
    if (world.curved.empty())
        throw std::runtime_error(
            options.city + ": the scene has no curved reflector; add a \"chrome lathe\" or \"chrome ball\".");
    return world;
}

}  // namespace

int benchChrome(const Options& options) {
    const MirrorWorld world = chromeWorld(options);
    const ChromeStage stage(world);
    const OffscreenContext context;
    ResultFile results("chrome", std::string(programVersion), context.renderer());
    Progress progress("chrome", 6 + 3 * stage.parts.size() + chromePictureSteps, options.quiet);
    ChromeBenchOptions how;
    how.seed = options.seed;
    how.car = options.car;
    how.carLength = options.carLength;
    how.save = options.save;
    if (options.publishedSearch) how.vertex.published = reflection::PublishedOptions{};
    how.searchOnGpu = options.chromeSearch == ChromeSearchOn::gpu ||
                      (options.chromeSearch == ChromeSearchOn::automatic && !context.software());
    how.interrupted = [] { return interrupted(); };
    how.advance = [&progress] { progress.advance(); };
    std::vector<MirrorRows> parts;
    const auto add = [&](MirrorRows part) {
        for (const nlohmann::ordered_json& row : part.rows) results.add(row);
        parts.push_back(std::move(part));
    };
    const auto wanted = [&](const char* part) {
        return (options.part.empty() || options.part == part) && !how.stop();
    };
    if (wanted("search")) add(chromeSearches(how));
    if (wanted("gpu")) add(chromeSearchesOnGpu(how));
    if (wanted("share")) add(chromeShares(stage, how));
    if (wanted("published")) add(publishedSearches(stage, how));
    if (wanted("still")) add(chromeStills(stage, how));
    if (wanted("frame")) add(chromeFrames(stage, how));
    if (wanted("picture")) add(chromePictures(stage, how));
    if (wanted("bounces")) {
        if (options.city == Options().city) add(chromeBounces(namedWorld("balls.json"), how));
        if (!how.stop()) add(chromeBounces(world, how));
    }
    if (wanted("none")) add(chromeNone(stage, how));
    std::vector<std::vector<std::string>> last;
    for (const MirrorRows& part : parts) {
        if (part.table.size() < 2) continue;
        if (!last.empty()) std::cout << formatTable(last) << '\n';
        std::cout << part.title << '\n';
        last = part.table;
    }
    return reportBench(options, results, last);
}

}  // namespace app
