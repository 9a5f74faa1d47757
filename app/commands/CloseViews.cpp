#include "app/commands/CloseViews.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "app/commands/CarsStage.h"
#include "app/commands/MirrorMask.h"
#include "app/commands/ReflectionSource.h"
#include "app/report/Progress.h"
#include "app/report/Timing.h"
#include "reflection/truth/ImageError.h"

namespace app {

namespace {

constexpr std::string_view truthName = "truth", chromeName = "chrome";

std::vector<std::uint32_t> indicesOf(std::span<const SeenVehicle> seen) {
    std::vector<std::uint32_t> indices;
    for (const SeenVehicle& v : seen) indices.push_back(v.index);
    return indices;
}

std::vector<glm::vec3> floats(const Picture& picture) {
    return toFloat({{picture.width, picture.height}, picture.rgba});
}

}  // namespace

CloseViews::CloseViews(const Scene& scene, const PreparedReflections& prepared, SceneRenderer& renderer,
                       glm::ivec2 resolution, Quality quality, const ChromeDrawing& drawing)
    : scene_(scene),
      prepared_(prepared),
      renderer_(renderer),
      quality_(quality),
      drawing_(drawing),
      target_(resolution),
      rays_(scene.city, scene.models),
      close_(scene.city, scene.models) {
    renderer.setCloseScene(&close_);
}

CloseViews::~CloseViews() {
    renderer_.setCloseScene(nullptr);
}

std::unique_ptr<ReflectionSource> CloseViews::sourceOf(std::string_view method, bool everyFrame) {
    if (method == truthName) return tracedTruth(rays_);
    ReflectionSettings settings;
    settings.method =
        method == chromeName
            ? ReflectionMethod::mem
            : fromName<ReflectionMethod>(reflectionMethodNames, method).value_or(ReflectionMethod::none);
    settings.quality = quality_;
    settings.everyFrame = everyFrame;
    return engineSource(scene_, prepared_, settings, rays_);
}

std::vector<unsigned char> CloseViews::pixelsOf(const FrameScene& frame, const Counts& counts) {
    renderer_.prepare(frame);
    rays_.prepare(frame);
    TraceOptions plain;
    plain.plain = true;
    const TracedPicture picture = rays_.render(frame.views.front(), plain);
    std::vector<unsigned char> mask(picture.kind.size());
    for (std::size_t i = 0; i < mask.size(); ++i)
        mask[i] = picture.kind[i] == SeenKind::vehicle && counts(picture, i) ? 1 : 0;
    return mask;
}

void CloseViews::drawFrame(const FrameScene& frame, std::string_view method, ReflectionSource& source,
                           Drawn* told, ChromeFades* fades) {
    const View& view = frame.views.front();
    renderer_.prepare(frame);
    const std::vector<SeenVehicle> seen = seenIn(renderer_, frame.views);
    source.beginFrame(frame, seen, renderer_);
    const bool chrome = method == chromeName;
    ChromePlan plan;
    if (chrome) plan = planChrome(frame, indicesOf(seen), scene_.models, close_.parts, {}, fades);
    if (chrome && fades) fades->follow(plan);
    renderer_.drawView(view, source.forView(view, renderer_), target_.framebuffer(), {},
                       {chrome ? &plan : nullptr, 0, drawing_});
    if (!chrome || !told) return;
    told->counts = renderer_.counters().chrome;
    told->plan = std::move(plan);
}

Picture CloseViews::shown(const FrameScene& frame, std::string_view method, ReflectionSource& source,
                          Drawn* told, ChromeFades* fades) {
    drawFrame(frame, method, source, told, fades);
    Image8 image = readPixels(target_.framebuffer(), target_.size());
    return {image.size.x, image.size.y, std::move(image.rgba)};
}

std::vector<CloseViews::Drawn> CloseViews::draw(const FrameScene& frame,
                                                std::span<const std::string_view> methods,
                                                std::span<const unsigned char> mask) {
    std::vector<Drawn> all;
    std::vector<glm::vec3> truth;
    for (const std::string_view method : methods) {
        if (interrupted()) break;
        const std::unique_ptr<ReflectionSource> source = sourceOf(method, true);
        Drawn drawn;
        drawn.method = method;
        drawn.picture = shown(frame, method, *source, &drawn);
        const std::vector<glm::vec3> pixels = floats(drawn.picture);
        if (truth.empty()) truth = pixels;
        const int w = drawn.picture.width, h = drawn.picture.height;
        drawn.psnr = reflection::psnr({w, h, pixels}, {w, h, truth}, mask);
        drawn.flip = reflection::meanError(reflection::flip({w, h, pixels}, {w, h, truth}), mask);
        all.push_back(std::move(drawn));
    }
    return all;
}

std::vector<std::vector<double>> CloseViews::time(const FrameScene& frame,
                                                  std::span<const std::string_view> methods,
                                                  std::uint32_t frames) {
    constexpr std::uint32_t warmUp = 4;
    std::vector<std::unique_ptr<ReflectionSource>> sources;
    for (const std::string_view method : methods) sources.push_back(sourceOf(method, false));
    std::vector<std::vector<double>> times(methods.size());
    for (std::uint32_t i = 0; i < warmUp + frames && !interrupted(); ++i)
        for (std::size_t k = 0; k < methods.size(); ++k) {
            const std::size_t m = (k + i) % methods.size();
            finishDrawing();
            const Stopwatch watch;
            drawFrame(frame, methods[m], *sources[m], nullptr);
            finishDrawing();
            if (i >= warmUp) times[m].push_back(watch.elapsed());
        }
    return times;
}

std::vector<CloseViews::Motion> CloseViews::move(const std::function<FrameScene(std::uint32_t)>& frameAt,
                                                 std::uint32_t count,
                                                 std::span<const std::string_view> methods,
                                                 const Counts& counts) {
    struct Side {
        std::unique_ptr<ReflectionSource> source;
        Picture now, before;
        ChromeFades fades = {};
    };
    std::vector<Side> sides;
    std::vector<Motion> motions;
    for (const std::string_view method : methods) {
        sides.push_back({sourceOf(method, false), {}, {}, {}});
        motions.push_back({});
        motions.back().method = method;
        motions.back().leastJobs = std::numeric_limits<std::uint32_t>::max();
    }
    std::vector<unsigned char> mask, before;
    for (std::uint32_t k = 0; k < count && !interrupted(); ++k) {
        const FrameScene frame = frameAt(k);
        before = std::exchange(mask, pixelsOf(frame, counts));
        for (std::size_t m = 0; m < methods.size(); ++m) {
            Drawn told;
            sides[m].before = std::exchange(
                sides[m].now, shown(frame, methods[m], *sides[m].source, &told, &sides[m].fades));
            const auto jobs = static_cast<std::uint32_t>(told.plan.jobs.size());
            motions[m].mostJobs = std::max(motions[m].mostJobs, jobs);
            motions[m].leastJobs = std::min(motions[m].leastJobs, jobs);
        }
        if (k == 0) continue;
        for (std::size_t i = 0; i < before.size(); ++i) before[i] &= mask[i];
        if (std::ranges::find(before, 1) == before.end()) continue;
        const std::vector<glm::vec3> truth = floats(sides.front().now),
                                     truthBefore = floats(sides.front().before);
        for (std::size_t m = 0; m < methods.size(); ++m) {
            const int w = sides[m].now.width, h = sides[m].now.height;
            const std::vector<glm::vec3> now = floats(sides[m].now), was = floats(sides[m].before);
            Motion& motion = motions[m];
            const double flicker =
                reflection::flicker({w, h, now}, {w, h, was}, {w, h, truth}, {w, h, truthBefore}, before);
            ++motion.frames;
            motion.change += reflection::meanError(reflection::flip({w, h, now}, {w, h, was}), before);
            motion.flip += reflection::meanError(reflection::flip({w, h, now}, {w, h, truth}), before);
            motion.flicker += flicker;
            motion.worst = std::max(motion.worst, flicker);
        }
    }
    for (Motion& motion : motions)
        for (double* sum : {&motion.change, &motion.flip, &motion.flicker})
            *sum /= std::max<std::uint32_t>(1, motion.frames);
    return motions;
}

}  // namespace app
