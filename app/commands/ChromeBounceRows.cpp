#include <algorithm>
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

namespace {

/// Texels of the environment maps' faces, as vehicles' local maps have them.
constexpr int mapFace = 128;
/// Timed frames.
constexpr int rounds = 3;
/// Mirrors in a row that rays follow.
constexpr int trueDepth = 8;
constexpr int deepest = 4;

float encoded(float linear) {
    const float v = std::clamp(linear, 0.f, 1.f);
    return v <= 0.0031308f ? 12.92f * v : 1.055f * std::pow(v, 1 / 2.4f) - 0.055f;
}

std::vector<glm::vec3> shown(const std::vector<glm::vec3>& radiance) {
    std::vector<glm::vec3> out;
    out.reserve(radiance.size());
    for (const glm::vec3& c : radiance) out.emplace_back(encoded(c.r), encoded(c.g), encoded(c.b));
    return out;
}

}  // namespace

MirrorRows chromeBounces(const MirrorWorld& world, const ChromeBenchOptions& options) {
    MirrorRows out;
    out.title = world.name +
                ": chrome in chrome against rays, over the pixels that two and three mirrors in a "
                "row show";
    out.table.push_back({"depth", "pictures", "texels", "unseen", "without a picture", "searched",
                         "search, ms", "plan, ms", "frame, ms", "2: PSNR, dB", "FLIP", "3: PSNR, dB",
                         "FLIP"});
    const TracedPicture truth = MirrorTruth(world).picture(
        world.view(options.picture), {.depth = trueDepth, .samples = 1, .seed = options.seed});
    std::vector<std::uint8_t> two(truth.level.size()), three(truth.level.size());
    for (std::size_t k = 0; k < truth.level.size(); ++k) {
        two[k] = truth.curved[k] != 0 && truth.level[k] == 2;
        three[k] = truth.curved[k] != 0 && truth.level[k] >= 3;
    }
    const std::vector<glm::vec3> trueShown = shown(truth.radiance);
    const auto view = [&](const std::vector<glm::vec3>& pixels) {
        return reflection::ImageView{options.picture.x, options.picture.y, pixels};
    };
    reflection::TreeSettings settings;
    settings.depth = trueDepth;
    settings.faceSize = mapFace;
    settings.mostMaps = 4096;
    std::vector<std::unique_ptr<MirrorStage>> stages;
    std::vector<std::vector<double>> ms(deepest);
    for (int depth = 1; depth <= deepest; ++depth) {
        reflection::MirrorPassOptions pass;
        pass.nearness = true;
        stages.push_back(
            std::make_unique<MirrorStage>(world, options.picture, reflection::CurvedMaps::cube, pass));
        reflection::VirtualMeshOptions mesh;
        mesh.vertices = options.vertex;
        mesh.vertices.search.thorough = false;
        reflection::ChromeTreeOptions bounces;
        bounces.depth = depth;
        stages.back()->setChrome(mesh, true, bounces);
    }
    // Maps see each other's last ones: they settle first.
    for (int round = -4; round < rounds; ++round)
        for (std::size_t s = 0; s < stages.size(); ++s) {
            if (options.stop()) return out;
            settings.refreshCurved = round < -1;
            const double time = frameTime(*stages[s], settings);
            if (round >= 0) ms[s].push_back(time);
        }
    for (std::size_t s = 0; s < stages.size(); ++s) {
        const std::vector<glm::vec3> radiance = stages[s]->read(), seen = shown(radiance);
        const ChromeFrame& frame = stages[s]->chromeFrame();
        const reflection::ChromeTreeCounters& c = stages[s]->chromeTree().counters;
        const std::vector<float> flip = reflection::flip(view(seen), view(trueShown));
        const double psnr2 = reflection::psnr(view(seen), view(trueShown), two),
                     psnr3 = reflection::psnr(view(seen), view(trueShown), three),
                     flip2 = reflection::meanError(flip, two), flip3 = reflection::meanError(flip, three);
        const Timing time = timingOf(ms[s]);
        const std::uint32_t without = c.tooDeep + c.tooSmall + c.tooNear + c.tooBent + c.overCap;
        double stray = 0;
        for (const reflection::ChromeNode& n : stages[s]->chromeTree().nodes)
            if (n.look == reflection::ChromeLook::picture) stray = std::max(stray, n.stray);
        out.table.push_back({std::to_string(s + 1), std::to_string(c.pictures), std::to_string(c.texels),
                             std::to_string(c.unseen), std::to_string(without),
                             std::to_string(frame.searched), fixed(frame.searchMilliseconds, 1),
                             fixed(frame.planMilliseconds, 2), fixed(time.median, 1), fixed(psnr2, 1),
                             fixed(flip2, 4), fixed(psnr3, 1), fixed(flip3, 4)});
        out.rows.push_back({{"part", "bounces"},
                            {"scene", world.name},
                            {"depth", s + 1},
                            {"width", options.picture.x},
                            {"height", options.picture.y},
                            {"pictures", c.pictures},
                            {"picture_texels", c.texels},
                            {"pairs", c.pairs},
                            {"unseen", c.unseen},
                            {"too_deep", c.tooDeep},
                            {"too_small", c.tooSmall},
                            {"too_near", c.tooNear},
                            {"too_bent", c.tooBent},
                            {"over_cap", c.overCap},
                            {"worst_stray_px", stray},
                            {"searched", frame.searched},
                            {"search_ms", frame.searchMilliseconds},
                            {"plan_ms", frame.planMilliseconds},
                            {"frame_ms", toJson(time)},
                            {"two_psnr_db", psnr2},
                            {"two_mean_flip", flip2},
                            {"three_psnr_db", psnr3},
                            {"three_mean_flip", flip3}});
        if (options.save)
            saveRadiance(radiance, options.picture, *options.save,
                         fileName(world.name + " bounces " + std::to_string(s + 1)));
    }
    if (options.save)
        saveRadiance(truth.radiance, options.picture, *options.save, fileName(world.name + " bounces truth"));
    if (options.advance) options.advance();
    return out;
}

}  // namespace app
