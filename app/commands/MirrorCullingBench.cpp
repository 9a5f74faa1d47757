#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "app/commands/MirrorBench.h"
#include "app/render/MirrorStage.h"
#include "app/report/ResultFile.h"
#include "app/report/Table.h"
#include "app/report/Timing.h"
#include "reflection/truth/ImageError.h"

namespace app {

using reflection::CurvedMaps;
using reflection::Economies;
using reflection::TreeSettings;

namespace {

/// A way to draw the scene.
struct Case {
    std::string name;
    Economies economies;
    bool together = false;  ///< maps of a level side by side, all faces in one framebuffer
    bool glossed = false;   ///< rough mirrors filtered once a texel
    bool clusters = true;
    double texelsPerPixel = TreeSettings{}.texelsPerPixel;
    bool plain = false;  ///< without any reflection
};

/// Cases that are measured in turns and compared with the first of them.
struct Group {
    std::string maps;
    CurvedMaps curved;
    glm::ivec2 mapSize;  ///< 0: the picture's
    std::vector<Case> cases;
};

/// Everything but what changes the picture.
Economies samePixels() {
    Economies e;
    e.cap = e.cutOff = e.detail = false;
    return e;
}

/// The paper's way, ours without and with the maps of a level together, nothing at all.
std::vector<Case> mainCases(const MirrorWorld& world) {
    const auto isRough = [](const MirrorWorld::Flat& f) { return f.mirror.plane.surface().roughness > 0; };
    std::vector<Case> cases{
        {"all", Economies::paper()}, {"culled", samePixels()}, {"culled, together", samePixels(), true}};
    if (std::ranges::any_of(world.mirrors, isRough))
        cases.push_back({"culled, together, gloss a texel", samePixels(), true, true});
    return cases;
}

/// Each economy by itself: with what is left out of the first case too, and the last of `main` without each.
std::vector<Case> switches(const MirrorWorld& world, const Case& best) {
    std::vector<Case> cases;
    Economies none = Economies::paper();
    none.backFacing = false;
    cases.push_back({"all, backs of mirrors too", none});
    const auto without = [&](const char* name, bool Economies::*member) {
        Case c = best;
        c.name = name;
        c.economies.*member = false;
        cases.push_back(c);
    };
    without("without back facing", &Economies::backFacing);
    without("without off screen", &Economies::offScreen);
    without("without narrow", &Economies::narrow);
    without("without scissor", &Economies::scissor);
    without("without resolution", &Economies::resolution);
    if (!world.occluders.empty()) without("without occlusion", &Economies::occlusion);
    without("without share", &Economies::share);
    Case c = best;
    c.name = "without clusters";
    c.clusters = false;
    cases.push_back(c);
    if (!world.curved.empty()) {
        c = best;
        c.name = "with a texel a pixel in faces";
        c.texelsPerPixel = 1;
        cases.push_back(c);
    }
    c = best;
    c.name = "with cap of 64 and cut-off";
    c.economies.cap = c.economies.cutOff = true;
    cases.push_back(c);
    return cases;
}

std::vector<Group> groupsOf(const MirrorWorld& world, bool eachEconomy) {
    const CurvedMaps cubes = world.curved.empty() ? CurvedMaps::none : CurvedMaps::cube;
    std::vector<Group> groups;
    if (!world.curved.empty())
        groups.push_back(
            {"256 x 256, view dependent", CurvedMaps::viewDependent, {256, 256}, mainCases(world)});
    groups.push_back(
        {cubes == CurvedMaps::none ? "256 x 256" : "256 x 256, cubes", cubes, {256, 256}, mainCases(world)});
    if (eachEconomy) {
        std::vector<Case>& cases = groups.back().cases;
        for (const Case& c : switches(world, cases.back())) cases.push_back(c);
    }
    groups.push_back({cubes == CurvedMaps::none ? "picture's texels" : "picture's texels, cubes",
                      cubes,
                      {0, 0},
                      mainCases(world)});
    for (Group& g : groups) {
        Case plain{"no reflections", samePixels()};
        plain.plain = true;
        g.cases.push_back(plain);
    }
    return groups;
}

TreeSettings settingsOf(const Group& group, const Case& c) {
    TreeSettings settings;
    settings.depth = c.plain ? 0 : 2;
    settings.economies = c.economies;
    settings.mapSize = group.mapSize;
    settings.faceSize = 128;
    settings.texelsPerPixel = c.texelsPerPixel;
    settings.mostMaps = c.economies.cap ? 64 : 1u << 20;
    return settings;
}

std::unique_ptr<MirrorStage> stageOf(const MirrorWorld& world, const glm::ivec2& size, const Group& group,
                                     const Case& c) {
    reflection::MirrorPassOptions how;
    how.format = reflection::MirrorFormat::rgba8;
    how.together = c.together;
    how.glossPerTexel = c.glossed;
    auto stage = std::make_unique<MirrorStage>(world, size, group.curved, how);
    stage->setClusters(c.clusters);
    return stage;
}

}  // namespace

MirrorRows culling(const MirrorWorld& world, const MirrorBenchOptions& options, bool eachEconomy) {
    MirrorRows out;
    out.title = world.name + ", depth 2: what culling is worth";
    out.table.push_back({"maps", "drawn", "maps", "faces", "triangles", "texels", "frame, ms", "all / this",
                         "reflections alone", "PSNR, dB"});
    for (const Group& group : groupsOf(world, eachEconomy)) {
        const std::size_t n = group.cases.size();
        std::vector<std::unique_ptr<MirrorStage>> stages;
        std::vector<std::vector<double>> times(n);
        std::vector<std::uint64_t> triangles(n);
        // Interleaved; the unculled one takes seconds on a street of windows.
        int rounds = 9;
        for (int round = 0; round <= rounds; ++round)
            for (std::size_t i = 0; i < n; ++i) {
                if (options.stop()) return out;
                if (round == 0) stages.push_back(stageOf(world, options.size, group, group.cases[i]));
                const TreeSettings settings = settingsOf(group, group.cases[i]);
                // Programs are compiled with the first frame, and environment maps know each other after it.
                if (round == 0) stages[i]->draw(settings);
                const std::uint64_t before = stages[i]->trianglesDrawn();
                const double ms = frameTime(*stages[i], settings);
                triangles[i] = stages[i]->trianglesDrawn() - before;
                if (round > 0) times[i].push_back(ms);
                if (round == 0 && ms > 500) rounds = ms > 5000 ? 1 : 3;
            }
        std::vector<glm::vec3> reference;
        for (std::size_t i = 0; i < n; ++i) {
            stages[i]->pass().resetCounters();
            const reflection::TreeCounters c = stages[i]->draw(settingsOf(group, group.cases[i])).counters;
            const std::vector<glm::vec3> image = stages[i]->read();
            if (i == 0) reference = image;
            const double psnr = i == 0 ? std::numeric_limits<double>::quiet_NaN()
                                       : reflection::psnr({options.size.x, options.size.y, image},
                                                          {options.size.x, options.size.y, reference});
            std::vector<double> ratio;
            for (std::size_t k = 0; k < times[i].size(); ++k) ratio.push_back(times[0][k] / times[i][k]);
            const double gain = timingOf(ratio).median;
            const double plain = timingOf(times.back()).median;
            const double alone =
                (timingOf(times[0]).median - plain) / std::max(timingOf(times[i]).median - plain, 1e-3);
            out.table.push_back({group.maps, group.cases[i].name, std::to_string(c.generated()),
                                 std::to_string(c.faces), std::to_string(triangles[i]),
                                 std::to_string(c.texels), fixed(timingOf(times[i]).median, 2),
                                 i == 0 ? "1" : fixed(gain, 2), group.cases[i].plain ? "-" : fixed(alone, 2),
                                 fixed(psnr, 1)});
            out.rows.push_back({{"part", "culling"},
                                {"scene", world.name},
                                {"maps", group.maps},
                                {"method", group.cases[i].name},
                                {"depth", 2},
                                {"generated", c.generated()},
                                {"environment_faces", c.faces},
                                {"environments_unseen", c.environmentsUnseen},
                                {"filtered", stages[i]->pass().counters().filtered},
                                {"texels", c.texels},
                                {"triangles_drawn", triangles[i]},
                                {"back_facing", c.backFacing},
                                {"off_screen", c.offScreen},
                                {"occluded", c.occluded},
                                {"shared", c.shared},
                                {"objects", c.objects},
                                {"objects_culled", c.objectsCulled},
                                {"frame_ms", toJson(timingOf(times[i]))},
                                {"ratio_to_all", gain},
                                {"ratio_to_all_reflections_alone", alone},
                                {"psnr_db", psnr}});
        }
        if (options.save)
            saveRadiance(stages[1]->read(), options.size, *options.save,
                         fileName(group.maps + " " + group.cases[1].name + " " + world.name));
        if (options.advance) options.advance();
    }
    return out;
}

}  // namespace app
