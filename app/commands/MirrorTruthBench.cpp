#include <algorithm>
#include <string>
#include <vector>

#include "app/commands/MirrorBench.h"
#include "app/display/OffscreenTarget.h"
#include "app/mirrors/MirrorTruth.h"
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

struct Drawn {
    std::vector<glm::vec3> image;
    Timing frame;
};

/// Four frames of warming up, as environment maps show each other's last ones, then a few that count.
Drawn drawn(const MirrorWorld& world, const glm::ivec2& size, CurvedMaps curved,
            const reflection::MirrorPassOptions& how) {
    MirrorStage stage(world, size, curved, how);
    TreeSettings settings;
    settings.depth = std::max(world.depth, world.curved.empty() ? 0 : 3);
    settings.mostMaps = 4096;
    std::vector<double> ms;
    for (int i = 0; i < 9; ++i) {
        const double frame = frameTime(stage, settings);
        if (i >= 4) ms.push_back(frame);
    }
    return {stage.read(), timingOf(ms)};
}

MirrorWorld withRoughBalls(MirrorWorld world, float roughness) {
    for (MirrorWorld::Curved& c : world.curved) c.reflector.surface.roughness = roughness;
    return world;
}

/// Flat mirrors as if nothing disturbed them.
MirrorWorld smoothed(MirrorWorld world) {
    for (MirrorWorld::Flat& f : world.mirrors) {
        f.mirror.plane =
            reflection::MirrorPlane::make(f.mirror.plane.corners(), {f.mirror.plane.surface().reflectance, 0})
                .mirror;
        f.ripples = {};
        f.mirror.reach = 0;
        f.fade = 0;
    }
    return world;
}

}  // namespace

bool hasDisturbedMirrors(const MirrorWorld& world) {
    return std::ranges::any_of(world.mirrors, [](const MirrorWorld::Flat& f) {
        return f.mirror.plane.surface().roughness > 0 || f.ripples.any() || f.fade > 0;
    });
}

MirrorRows flatError(const MirrorWorld& world, const MirrorBenchOptions& options) {
    MirrorRows out;
    out.title = world.name + ": rough, bumped and fading flat mirrors against the ray traced truth";
    out.table.push_back({"drawn", "frame, ms", "PSNR on flat mirrors, dB", "PSNR of the picture, dB"});
    const glm::ivec2 size = options.size / 2;
    const int bounces = world.curved.empty() ? world.depth : 8;
    const TracedPicture truth =
        MirrorTruth(world).picture(world.view(size), {.depth = bounces, .samples = 128});
    std::vector<unsigned char> flat(truth.level.size());
    for (std::size_t i = 0; i < flat.size(); ++i)
        flat[i] = truth.level[i] > 0 && truth.curved[i] == 0 ? 1 : 0;
    const CurvedMaps curved = world.curved.empty() ? CurvedMaps::none : CurvedMaps::cube;
    struct Case {
        const char* name;
        bool smooth = false, glossed = false;
    };
    for (const Case& c : {Case{"as they are"}, Case{"as they are, gloss a texel", false, true},
                          Case{"as if smooth, level and lasting", true}}) {
        if (options.stop()) return out;
        reflection::MirrorPassOptions how;
        how.nearness = !world.curved.empty();
        how.glossPerTexel = c.glossed;
        const MirrorWorld shown = c.smooth ? smoothed(world) : world;
        const Drawn d = drawn(shown, size, curved, how);
        const double on = psnrOf(d.image, truth.radiance, size, flat),
                     whole = psnrOf(d.image, truth.radiance, size);
        out.table.push_back({c.name, fixed(d.frame.median, 2), fixed(on, 1), fixed(whole, 1)});
        out.rows.push_back({{"part", "disturbed"},
                            {"scene", world.name},
                            {"method", c.name},
                            {"width", size.x},
                            {"height", size.y},
                            {"frame_ms", toJson(d.frame)},
                            {"psnr_db_on_flat", on},
                            {"psnr_db", whole}});
        if (options.save) saveRadiance(d.image, size, *options.save, fileName(world.name + " " + c.name));
    }
    if (options.save) saveRadiance(truth.radiance, size, *options.save, fileName(world.name + " truth"));
    if (options.advance) options.advance();
    return out;
}

MirrorRows roughCurvedError(const MirrorWorld& given, const MirrorBenchOptions& options) {
    MirrorRows out;
    out.title = given.name + ": rough curved reflectors against ray tracing of eight bounces";
    out.table.push_back({"maps", "roughness", "frame, ms", "PSNR on curved, dB", "as if smooth, dB"});
    const glm::ivec2 size = options.size / 2;
    struct Case {
        const char* name;
        CurvedMaps curved;
        bool nearness;
    };
    for (float roughness : {0.3f, 0.5f}) {
        const MirrorWorld world = withRoughBalls(given, roughness);
        const TracedPicture truth =
            MirrorTruth(world).picture(world.view(size), {.depth = 8, .samples = 128});
        for (const Case& c : {Case{"view dependent", CurvedMaps::viewDependent, false},
                              Case{"cube, parallax", CurvedMaps::cube, true},
                              Case{"paraboloids, parallax", CurvedMaps::dualParaboloid, true}}) {
            if (options.stop()) return out;
            reflection::MirrorPassOptions how;
            how.nearness = c.nearness;
            const Drawn rough = drawn(world, size, c.curved, how);
            const Drawn smooth = drawn(withRoughBalls(given, 0), size, c.curved, how);
            const double on = psnrOf(rough.image, truth.radiance, size, truth.curved);
            const double off = psnrOf(smooth.image, truth.radiance, size, truth.curved);
            out.table.push_back({c.name, fixed(static_cast<double>(roughness), 1),
                                 fixed(rough.frame.median, 2), fixed(on, 1), fixed(off, 1)});
            out.rows.push_back({{"part", "rough curved"},
                                {"scene", world.name},
                                {"method", c.name},
                                {"roughness", roughness},
                                {"frame_ms", toJson(rough.frame)},
                                {"psnr_db_on_curved", on},
                                {"psnr_db_on_curved_if_smooth", off}});
            if (options.save)
                saveRadiance(rough.image, size, *options.save,
                             fileName(world.name + " rough " + fixed(static_cast<double>(roughness), 1) +
                                      " " + c.name));
        }
        if (options.save)
            saveRadiance(
                truth.radiance, size, *options.save,
                fileName(world.name + " rough " + fixed(static_cast<double>(roughness), 1) + " traced"));
    }
    if (options.advance) options.advance();
    return out;
}

}  // namespace app
