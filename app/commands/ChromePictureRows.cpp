#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "app/commands/ChromeBench.h"
#include "app/display/OffscreenTarget.h"
#include "app/mirrors/MirrorTruth.h"
#include "app/render/MirrorStage.h"
#include "app/report/ResultFile.h"
#include "app/report/Table.h"
#include "app/report/Timing.h"
#include "reflection/truth/ImageError.h"

namespace app {

using reflection::CurvedMaps;
using reflection::TreeSettings;

namespace {

/// Texels to a side of a cube's faces: as many as a vehicle's local map has, and as many as show all that a
/// reflector covering a quarter of the picture can.
constexpr int mapFace = 128, perfectFace = 512;
/// Rounds of pictures and of whole frames: seconds each.
constexpr int rounds = 3;

struct Method {
    std::string name;
    int face = mapFace;
    bool parallax = false;
    std::optional<double> share;  ///< of searches; nothing: environment maps alone
    bool published = false;
    bool onGpu = false;
    bool concave = false;  ///< bowls too, all their images
};

std::unique_ptr<MirrorStage> stageFor(const MirrorWorld& world, const Method& method,
                                      const ChromeBenchOptions& options) {
    reflection::MirrorPassOptions pass;
    pass.nearness = method.parallax;
    auto stage = std::make_unique<MirrorStage>(world, options.picture, CurvedMaps::cube, pass);
    if (method.share) {
        reflection::VirtualMeshOptions mesh;
        mesh.vertices = options.vertex;
        mesh.vertices.share = *method.share;
        if (method.published) mesh.vertices.published = reflection::PublishedOptions{};
        stage->setChrome(mesh, method.concave);
        if (method.onGpu) stage->searchChromeOnGpu();
    }
    return stage;
}

TreeSettings settingsFor(const MirrorWorld& world, int face, bool refresh) {
    TreeSettings settings;
    settings.depth = world.depth;
    settings.faceSize = face;
    settings.mostMaps = 4096;
    settings.refreshCurved = refresh;
    return settings;
}

/// As a screen shows it, 0..1.
std::vector<glm::vec3> shown(const std::vector<glm::vec3>& radiance) {
    std::vector<glm::vec3> out;
    out.reserve(radiance.size());
    for (const glm::vec3& c : radiance) {
        glm::vec3 s;
        for (int k = 0; k < 3; ++k) {
            const float v = std::clamp(c[k], 0.f, 1.f);
            s[k] = v <= 0.0031308f ? 12.92f * v : 1.055f * std::pow(v, 1 / 2.4f) - 0.055f;
        }
        out.push_back(s);
    }
    return out;
}

Timing difference(const std::vector<double>& a, const std::vector<double>& b, double divisor = 1) {
    std::vector<double> d;
    for (std::size_t k = 0; k < a.size(); ++k) d.push_back((a[k] - b[k]) / divisor);
    return timingOf(d);
}

}  // namespace

MirrorRows chromeFrames(const ChromeStage& stage, const ChromeBenchOptions& options) {
    MirrorRows out;
    out.title = stage.world.name + ": whole frames with chrome, environment maps kept";
    out.table.push_back({"share, %", "searched", "lookups", "triangles", "search, ms", "frame, ms", "fps",
                         "paper", "faster than 100 %", "paper"});
    constexpr std::array<std::array<double, 2>, 5> paper{
        {{1, 1.3}, {0.143, 8.3}, {0.096, 10.1}, {0.055, 13.6}, {0.041, 16.3}}};
    std::vector<std::unique_ptr<MirrorStage>> stages;
    for (const auto& p : paper)
        stages.push_back(stageFor(stage.world, {"", mapFace, true, p[0], false}, options));
    std::vector<std::vector<double>> ms(stages.size()), search(stages.size());
    for (int round = -2; round < rounds; ++round)
        for (std::size_t s = 0; s < stages.size(); ++s) {
            if (options.stop()) return out;
            const double time = frameTime(*stages[s], settingsFor(stage.world, mapFace, round < -1));
            if (round < 0) continue;
            ms[s].push_back(time);
            search[s].push_back(stages[s]->chromeFrame().searchMilliseconds);
        }
    for (std::size_t s = 0; s < stages.size(); ++s) {
        const ChromeFrame& frame = stages[s]->chromeFrame();
        std::vector<double> ratios;
        for (std::size_t k = 0; k < ms[s].size(); ++k) ratios.push_back(ms[0][k] / ms[s][k]);
        const double faster = timingOf(ratios).median, theirs = paper[s][1] / paper[0][1];
        const Timing time = timingOf(ms[s]), searching = timingOf(search[s]);
        out.table.push_back({fixed(100 * paper[s][0], 1), std::to_string(frame.searched),
                             std::to_string(frame.lookups), std::to_string(frame.triangles),
                             fixed(searching.median, 2), fixed(time.median, 2), fixed(1000 / time.median, 1),
                             fixed(paper[s][1], 1), fixed(faster, 2) + "x", fixed(theirs, 1) + "x"});
        out.rows.push_back({{"part", "frame"},
                            {"scene", stage.world.name},
                            {"share", paper[s][0]},
                            {"searched", frame.searched},
                            {"lookups", frame.lookups},
                            {"virtual_vertices", frame.vertices},
                            {"virtual_triangles", frame.triangles},
                            {"search_ms", toJson(searching)},
                            {"width", options.picture.x},
                            {"height", options.picture.y},
                            {"frame_ms", toJson(time)},
                            {"paper_fps", paper[s][1]},
                            {"ratio_to_full", faster},
                            {"paper_ratio", theirs}});
    }
    if (options.advance) options.advance();
    return out;
}

MirrorRows chromePictures(const ChromeStage& stage, const ChromeBenchOptions& options) {
    MirrorRows out;
    out.title = stage.world.name + ": pictures against rays, over the chrome's pixels";
    out.table.push_back({"method", "PSNR, dB", "FLIP", "of re-rendering's", "asked", "cost, ms",
                         "of a re-rendered map's", "asked", "jobs", "searched"});
    const MirrorWorld& world = stage.world;
    const TracedPicture truth = MirrorTruth(world).picture(
        world.view(options.picture), {.depth = world.depth, .samples = 1, .seed = options.seed});
    const std::vector<glm::vec3> trueShown = shown(truth.radiance);
    const auto view = [&](const std::vector<glm::vec3>& pixels) {
        return reflection::ImageView{options.picture.x, options.picture.y, pixels};
    };
    const std::vector<Method> methods{
        {"map", mapFace, false, {}, false},
        {"map with parallax", mapFace, true, {}, false},
        {"re-rendered", perfectFace, false, {}, false},
        {"re-rendered with parallax", perfectFace, true, {}, false},
        {options.searchOnGpu ? "chrome, all searched, gpu" : "chrome, all searched", mapFace, true, 1.0,
         false, options.searchOnGpu},
        {"chrome, 9.6 %", mapFace, true, 0.096, false},
        {"chrome, 9.6 %, bowls too", mapFace, true, 0.096, false, false, true},
        {"chrome, as published", mapFace, true, 1.0, true}};
    constexpr std::size_t rerendered = 2;
    // The same maps, kept and re-rendered, without chrome: what a map costs, and what chrome adds.
    const auto kept = stageFor(world, methods[1], options), again = stageFor(world, methods[1], options),
               fine = stageFor(world, methods[3], options);
    std::vector<std::unique_ptr<MirrorStage>> stages;
    for (const Method& m : methods) stages.push_back(stageFor(world, m, options));
    std::vector<std::vector<double>> ms(methods.size());
    std::vector<double> keptMs, againMs, fineMs;
    for (int round = -2; round < rounds; ++round) {
        if (options.stop()) return out;
        const bool settling = round < -1;
        const double times[]{frameTime(*kept, settingsFor(world, mapFace, settling)),
                             frameTime(*again, settingsFor(world, mapFace, true)),
                             frameTime(*fine, settingsFor(world, perfectFace, true))};
        if (round >= 0) keptMs.push_back(times[0]), againMs.push_back(times[1]), fineMs.push_back(times[2]);
        for (std::size_t m = 0; m < methods.size(); ++m) {
            // The published search takes a hundred times as long: one frame of it is enough.
            if (methods[m].published && round < rounds - 1) continue;
            const double time =
                frameTime(*stages[m], settingsFor(world, methods[m].face, settling || methods[m].published));
            if (round >= 0) ms[m].push_back(time);
        }
    }
    const auto maps = static_cast<double>(std::max<std::size_t>(world.curved.size(), 1));
    const Timing map = difference(againMs, keptMs, maps), perfect = difference(fineMs, keptMs, maps);
    double reference = 0;
    for (std::size_t pass = 0; pass < 2; ++pass)
        for (std::size_t m = 0; m < methods.size(); ++m) {
            if (pass == 0 && m != rerendered) continue;
            const std::vector<glm::vec3> radiance = stages[m]->read(), seen = shown(radiance);
            const double psnr = reflection::psnr(view(seen), view(trueShown), truth.curved);
            const double flip =
                reflection::meanError(reflection::flip(view(seen), view(trueShown)), truth.curved);
            if (pass == 0) {
                reference = flip;
                continue;
            }
            const Method& method = methods[m];
            const bool chrome = method.share.has_value();
            const Timing cost = method.published             ? difference(ms[m], {keptMs.back()})
                                : chrome                     ? difference(ms[m], keptMs)
                                : method.face == perfectFace ? perfect
                                                             : map;
            const double ofMap = cost.median / std::max(map.median, 1e-6);
            const ChromeFrame& frame = stages[m]->chromeFrame();
            out.table.push_back({method.name, fixed(psnr, 1), fixed(flip, 4), fixed(flip / reference, 2),
                                 chrome ? "<= 0.5" : "", fixed(cost.median, 2), fixed(ofMap, 2),
                                 chrome ? "< 1" : "", std::to_string(frame.jobs),
                                 std::to_string(frame.searched)});
            nlohmann::ordered_json row{{"part", "picture"},
                                       {"scene", world.name},
                                       {"method", method.name},
                                       {"face_size", method.face},
                                       {"parallax", method.parallax},
                                       {"width", options.picture.x},
                                       {"height", options.picture.y},
                                       {"psnr_db", psnr},
                                       {"mean_flip", flip},
                                       {"ratio_to_rerender", flip / reference},
                                       {"cost_ms", toJson(cost)},
                                       {"cost_of_a_map", ofMap},
                                       {"jobs", frame.jobs},
                                       {"searched", frame.searched},
                                       {"search_ms", frame.searchMilliseconds}};
            if (chrome) row["asked"] = {{"ratio_to_rerender", 0.5}, {"cost_of_a_map", 1}};
            out.rows.push_back(std::move(row));
            if (options.save) {
                std::string name = "chrome " + method.name;
                std::replace_if(
                    name.begin(), name.end(), [](char c) { return c == ' ' || c == ',' || c == '%'; }, '_');
                saveRadiance(radiance, options.picture, *options.save, name);
            }
            if (options.advance) options.advance();
        }
    if (options.save) saveRadiance(truth.radiance, options.picture, *options.save, "chrome_truth");
    if (options.advance) options.advance();
    return out;
}

MirrorRows chromeNone(const ChromeStage& stage, const ChromeBenchOptions& options) {
    MirrorRows out;
    out.title = "where there is no close chrome to see";
    out.table.push_back(
        {"scene", "jobs", "meshes", "searched", "frame with chrome, ms", "without", "ratio", "asked"});
    MirrorWorld away = stage.world, alone = stage.world, none = stage.world;
    away.name += ", looking away";
    away.target = 2.0 * away.eye - away.target;
    alone.name += ", its chrome alone";
    alone.objects.clear();
    none.name += ", without chrome";
    none.curved.clear();
    for (const MirrorWorld* world : {&away, &alone, &none}) {
        const auto with = stageFor(*world, {"", mapFace, true, 1.0, false}, options),
                   without = stageFor(*world, {"", mapFace, true, {}, false}, options);
        std::vector<double> ratios, a, b;
        for (int round = -3; round < 3 * options.repeats; ++round) {
            if (options.stop()) return out;
            const TreeSettings settings = settingsFor(*world, mapFace, round < -1);
            const double x = frameTime(*with, settings), y = frameTime(*without, settings);
            if (round < 0) continue;
            a.push_back(x), b.push_back(y), ratios.push_back(x / y);
        }
        const ChromeFrame& frame = with->chromeFrame();
        const double ratio = timingOf(ratios).median;
        out.table.push_back({world->name, std::to_string(frame.jobs), std::to_string(frame.meshes),
                             std::to_string(frame.searched), fixed(timingOf(a).median, 2),
                             fixed(timingOf(b).median, 2), fixed(ratio, 3), "0 jobs, 1.00"});
        out.rows.push_back({{"part", "none"},
                            {"scene", world->name},
                            {"jobs", frame.jobs},
                            {"meshes", frame.meshes},
                            {"searched", frame.searched},
                            {"frame_ms", toJson(timingOf(a))},
                            {"frame_without_ms", toJson(timingOf(b))},
                            {"ratio_to_none", ratio},
                            {"asked", {{"jobs", 0}, {"ratio_to_none", 1}}}});
    }
    if (options.advance) options.advance();
    return out;
}

}  // namespace app
