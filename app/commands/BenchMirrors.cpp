#include <iostream>
#include <map>
#include <stdexcept>

#include "app/commands/Benches.h"
#include "app/commands/MirrorBench.h"
#include "app/commands/Version.h"
#include "app/display/OffscreenContext.h"
#include "app/report/Progress.h"
#include "app/report/Table.h"
#include "reflection/gl/ShaderSource.h"

namespace app {

namespace {

/// Nielsen & Christensen 2002, Table 1.
const std::map<std::string, PaperRow> paperTable{{"paper_a", {38, 62, 26, 1, 0.5, 1.8, 0.9, 1.9, 19, 10, 21}},
                                                 {"paper_b", {16, 19, 1, 3, 0.5, 1.0, 1.6, 1.4, 32, 17, 97}},
                                                 {"paper_c", {16, 28, 4, 2, 0.5, 1.0, 1.3, 1.3, 29, 8, 44}},
                                                 {"paper_d", {46, 69, 15, 1, 0.8, 1.0, 1.1, 1.1, 13, 7, 27}}};

/// The scenes to measure: the paper's, or the one that was named.
std::vector<std::pair<MirrorWorld, const PaperRow*>> scenesOf(const Options& options) {
    std::vector<std::pair<MirrorWorld, const PaperRow*>> scenes;
    if (options.city != Options().city) {
        if (!options.city.ends_with(".json"))
            throw std::runtime_error(
                "'" + options.city +
                "': mirrors are measured in scenes of their own; name a scene FILE.json, or nothing.");
        scenes.emplace_back(loadMirrorWorld(options.city), nullptr);
        return scenes;
    }
    for (const auto& [name, row] : paperTable)
        scenes.emplace_back(loadMirrorWorld(reflection::gl::dataFolder() / "scenes" / (name + ".json")),
                            &row);
    return scenes;
}

}  // namespace

int benchMirrors(const Options& options) {
    const auto scenes = scenesOf(options);
    const bool paper = scenes.front().second != nullptr;
    const OffscreenContext context;
    ResultFile results("mirrors", std::string(programVersion), context.renderer());
    const MirrorWorld street = streetOfWindows(100);
    std::vector<MirrorWorld> disturbed, planar;
    for (const auto& [world, row] : scenes) {
        if (hasDisturbedMirrors(world))
            disturbed.push_back(world);
        else if (!world.mirrors.empty())
            planar.push_back(world);
    }
    if (paper) {
        disturbed.push_back(loadMirrorWorld(reflection::gl::dataFolder() / "scenes" / "water.json"));
        planar.push_back(facingWindows(0));
        planar.push_back(street);
    }
    // Table 1: four kinds of maps; culling: three groups, two without curved reflectors; curved ones: two
    // errors.
    std::size_t steps = disturbed.size() + planar.size() + (paper ? 16 + 2 : 0);
    for (const auto& [world, row] : scenes) steps += 4 + (world.curved.empty() ? 2 : 3 + 2);
    Progress progress("mirrors", steps, options.quiet);
    MirrorBenchOptions how;
    how.save = options.save;
    how.interrupted = [] { return interrupted(); };
    how.advance = [&progress] { progress.advance(); };
    std::vector<MirrorRows> parts;
    const auto add = [&](MirrorRows part) {
        for (const nlohmann::ordered_json& row : part.rows) results.add(row);
        parts.push_back(std::move(part));
    };
    for (const auto& [world, row] : scenes) add(tableOne(world, row, how));
    for (const auto& [world, row] : scenes) add(culling(world, how, true));
    if (paper) add(culling(street, how, true));
    for (const auto& [world, row] : scenes)
        if (!world.curved.empty() && !how.stop()) {
            add(curvedError(world, how));
            add(roughCurvedError(world, how));
        }
    for (const MirrorWorld& world : disturbed)
        if (!how.stop()) add(flatError(world, how));
    if (paper) {
        add(facingDepths(0.15f, how));
        add(facingDepths(0.f, how));
    }
    for (const MirrorWorld& world : planar) add(againstStencil(world, how));
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
