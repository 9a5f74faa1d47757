#include <algorithm>
#include <string>

#include "app/commands/MirrorBench.h"
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

double psnrOf(const std::vector<glm::vec3>& a, const std::vector<glm::vec3>& b, const glm::ivec2& size,
              reflection::PixelMask mask = {}) {
    return reflection::psnr({size.x, size.y, a}, {size.x, size.y, b}, mask);
}

}  // namespace

MirrorRows facingDepths(float roughness, const MirrorBenchOptions& options) {
    const MirrorWorld world = facingWindows(roughness);
    const glm::ivec2 size = options.size / 2;
    MirrorRows out;
    out.title = "two facing windows, roughness " + fixed(static_cast<double>(roughness), 2) +
                ": each depth against the ray traced truth of that depth";
    out.table.push_back({"depth", "maps", "map bytes", "depth and distance bytes", "blur bytes", "frame, ms",
                         "PSNR on mirrors, dB", "PSNR of the deepest, dB", "PSNR of the picture, dB"});
    const MirrorTruth truth(world);
    MirrorStage stage(world, size, CurvedMaps::none);
    for (int depth = 1; depth <= world.depth; ++depth) {
        if (options.stop()) return out;
        TreeSettings settings;
        settings.depth = depth;
        std::vector<double> ms;
        for (int i = 0; i < 5; ++i) {
            finishDrawing();
            const Stopwatch watch;
            stage.draw(settings);
            finishDrawing();
            if (i > 0) ms.push_back(watch.elapsed());
        }
        const std::vector<glm::vec3> image = stage.read();
        const std::size_t maps = stage.draw(settings).nodes.size();
        const reflection::MirrorPassCounters held = stage.pass().counters();
        const TracedPicture traced = truth.picture(world.view(size), {.depth = depth, .samples = 256});
        std::vector<unsigned char> deepest(traced.level.size());
        for (std::size_t i = 0; i < deepest.size(); ++i) deepest[i] = traced.level[i] == depth ? 1 : 0;
        const double mirrors = psnrOf(image, traced.radiance, size, traced.level);
        const double last = psnrOf(image, traced.radiance, size, deepest);
        const double all = psnrOf(image, traced.radiance, size);
        out.table.push_back({std::to_string(depth), std::to_string(maps), std::to_string(held.mapBytes),
                             std::to_string(held.depthBytes), std::to_string(held.blurBytes),
                             fixed(timingOf(ms).median, 2), fixed(mirrors, 1), fixed(last, 1),
                             fixed(all, 1)});
        out.rows.push_back({{"part", "depth"},
                            {"scene", world.name},
                            {"roughness", roughness},
                            {"depth", depth},
                            {"generated", maps},
                            {"map_bytes", held.mapBytes},
                            {"depth_bytes", held.depthBytes},
                            {"blur_bytes", held.blurBytes},
                            {"width", size.x},
                            {"height", size.y},
                            {"frame_ms", toJson(timingOf(ms))},
                            {"psnr_db_on_mirrors", mirrors},
                            {"psnr_db_on_deepest", last},
                            {"psnr_db", all}});
        if (options.save && (depth == 1 || depth == 3 || depth == 8)) {
            const std::string name =
                "facing_" + fixed(static_cast<double>(roughness), 2) + "_depth_" + std::to_string(depth);
            saveRadiance(image, size, *options.save, name);
            saveRadiance(traced.radiance, size, *options.save, name + "_traced");
        }
        if (options.advance) options.advance();
    }
    return out;
}

MirrorRows againstStencil(const MirrorWorld& world, const MirrorBenchOptions& options) {
    MirrorRows out;
    out.title = "maps against stencils, " + world.name;
    out.table.push_back({"maps", "depth", "maps, ms", "stencils, ms", "PSNR, dB"});
    struct Case {
        const char* name;
        reflection::MirrorFormat format;
        glm::ivec2 mapSize;
    };
    for (const Case& c : {Case{"picture's texels, half floats", reflection::MirrorFormat::rgba16f, {0, 0}},
                          Case{"picture's texels, bytes", reflection::MirrorFormat::rgba8, {0, 0}},
                          Case{"256 x 256, bytes", reflection::MirrorFormat::rgba8, {256, 256}}}) {
        reflection::MirrorPassOptions how;
        how.format = c.format;
        MirrorStage stage(world, options.size, CurvedMaps::none, how);
        for (int depth : {1, 2, 4, 8}) {
            if (options.stop()) return out;
            if (depth > std::max(world.depth, 2)) break;
            TreeSettings settings;
            settings.depth = depth;
            settings.mapSize = c.mapSize;
            settings.mostMaps = 1u << 20;
            settings.cutOff = 0;
            std::vector<double> ms[2];
            std::vector<glm::vec3> image[2];
            for (int i = 0; i < 6; ++i)
                for (int way = 0; way < 2; ++way) {
                    finishDrawing();
                    const Stopwatch watch;
                    way == 0 ? stage.draw(settings) : stage.drawWithStencil(settings);
                    finishDrawing();
                    if (i > 0) ms[way].push_back(watch.elapsed());
                    if (i == 0) image[way] = stage.read();
                }
            const double psnr = psnrOf(image[0], image[1], options.size);
            out.table.push_back({c.name, std::to_string(depth), fixed(timingOf(ms[0]).median, 2),
                                 fixed(timingOf(ms[1]).median, 2), fixed(psnr, 1)});
            out.rows.push_back({{"part", "stencil"},
                                {"scene", world.name},
                                {"maps", c.name},
                                {"depth", depth},
                                {"maps_ms", toJson(timingOf(ms[0]))},
                                {"stencils_ms", toJson(timingOf(ms[1]))},
                                {"psnr_db", psnr}});
        }
    }
    if (options.advance) options.advance();
    return out;
}

}  // namespace app
