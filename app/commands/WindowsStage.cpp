#include "app/commands/WindowsStage.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "app/commands/MirrorMask.h"
#include "app/frame/AssembleFrame.h"
#include "app/raytrace/Edges.h"
#include "app/report/Timing.h"
#include "reflection/gl/SoftwareRenderer.h"

namespace app {

namespace {

/// Mirrors in a row of the truth: the fifth would add 1% of 1%.
constexpr int truthDepth = 4;
/// After so many frames of a standing view all cars' maps are as fine as they get.
constexpr int framesOfAge = 8;

}  // namespace

WindowsStage::WindowsStage(const Scene& scene, const PreparedReflections& prepared, SceneRenderer& renderer,
                           glm::ivec2 resolution, const std::vector<WindowsCase>& cases,
                           const ReflectionSettings& reflections)
    : scene_(scene), renderer_(renderer), planner_(scene.glass.fronts), target_(resolution) {
    renderer_.setGlass(scene.glass.fronts);
    for (const WindowsCase& what : cases) {
        WindowsRun& run = runs_.emplace_back();
        run.what = what;
        run.engine =
            std::make_unique<ReflectionEngine>(*prepared.tracer, prepared.maps, scene.models, reflections);
    }
}

FrameScene WindowsStage::frameOf(const CarsStage& set) const {
    return assembleFrame(scene_.city, *set.traffic, scene_.lighting, {set.view}, scene_.staged);
}

Image8 WindowsStage::picture(WindowsRun& run, const FrameScene& frame, int times) {
    for (int i = 0; i < std::max(times, 1); ++i) draw(run, frame);
    return readPixels(target_.framebuffer(), resolution());
}

MirrorPlan WindowsStage::planOf(const WindowsCase& what, const FrameScene& frame) const {
    if (!what.glass) return {};
    return planner_.plan(frame.views, what.settings,
                         [&](const auto& from, const auto* glass, const auto& box) {
                             return renderer_.hides(from, glass, box);
                         });
}

std::vector<SeenVehicle> WindowsStage::seenBy(const FrameScene& frame,
                                              const PlanarReflections& planar) const {
    std::vector<SeenVehicle> seen;
    for (const auto& v : renderer_.visibleVehicles(frame.views.front(), planar))
        seen.push_back({v.index, v.diameterPixels});
    return seen;
}

/// One frame, until OpenGL had finished: milliseconds.
double WindowsStage::draw(WindowsRun& run, const FrameScene& frame) {
    finishDrawing();
    const Stopwatch watch;
    renderer_.prepare(frame);
    const MirrorPlan plan = planOf(run.what, frame);
    const PlanarReflections planar{run.what.glass ? &plan : nullptr, 0,
                                   run.what.settings.wetRoad.has_value()};
    const ReflectionPlan& maps = run.engine->update(frame, seenBy(frame, planar), renderer_);
    renderer_.drawView(frame.views.front(), {run.engine->textures(), maps.slots}, target_.framebuffer(),
                       planar);
    finishDrawing();
    const double ms = watch.elapsed();
    run.planned = plan.counters;
    run.drawn = renderer_.counters();
    return ms;
}

void WindowsStage::measure(CarsStage& set, std::uint32_t frames, Progress& progress) {
    for (std::uint32_t i = 0; i < framesBefore + frames && !interrupted(); ++i) {
        set.traffic->step();
        const FrameScene frame = frameOf(set);
        double first = 0;
        for (WindowsRun& run : runs_) {
            if (i >= framesBefore + run.what.frames) continue;
            const double ms = draw(run, frame);
            if (&run == &runs_.front()) first = ms;
            if (i < framesBefore) continue;
            run.ms.push_back(ms);
            run.ratio.push_back(ms / first);
        }
        progress.advance();
    }
}

void WindowsStage::measureAway(const CarsStage& set, const std::string& name, std::uint32_t frames) {
    FrameScene frame = frameOf(set);
    frame.views.front() = lookAt(set.view.eye, set.view.eye + glm::dvec3(0.1, 0, 1), 1.0, resolution());
    const auto with =
        std::ranges::find_if(runs_, [&](const WindowsRun& run) { return run.what.name == name; });
    if (with == runs_.end()) return;
    const MirrorCounters planned = with->planned;
    const RenderCounters drawn = with->drawn;
    for (std::uint32_t i = 0; i < framesBefore + frames && !interrupted(); ++i) {
        const bool first = i % 2 == 0;
        double with_ = 0, without = 0;
        if (first) without = draw(runs_.front(), frame);
        with_ = draw(*with, frame);
        with->awayPasses = std::max(with->awayPasses, with->planned.passes);
        with->awayBytes = std::max(with->awayBytes, with->drawn.mirrorTextureBytes);
        if (!first) without = draw(runs_.front(), frame);
        if (i < framesBefore) continue;
        with->awayMs.push_back(with_);
        with->awayRatio.push_back(with_ / without);
    }
    with->planned = planned;  // those of the measurement
    with->drawn = drawn;
}

WindowsTruth WindowsStage::truthOf(const FrameScene& frame, bool wet) {
    const View& view = frame.views.front();
    renderer_.prepare(frame);
    RayTracer tracer(scene_.city, scene_.models);
    tracer.useTextureFilter(reflection::softwareRenderer() ? TextureFilter::llvmpipe
                                                           : TextureFilter::standard);
    tracer.prepare(frame);
    tracer.useSunMap(renderer_.sunMap());
    TraceOptions trace;
    trace.samples = 4;
    trace.bounces = 2;
    trace.windows = truthDepth;
    trace.wet = wet;
    trace.film = 256;
    const TracedPicture traced = tracer.render(view, trace);
    WindowsTruth truth{traced.display(frame.lighting.exposure), edgesOf(traced, view), {}};
    truth.water = truth.glass;
    for (std::size_t i = 0; i < truth.glass.size(); ++i) {
        const bool edge = truth.glass[i] != 0;
        truth.glass[i] = !edge && traced.kind[i] == SeenKind::glass ? 1 : 0;
        truth.water[i] = !edge && traced.kind[i] == SeenKind::water ? 1 : 0;
    }
    return truth;
}

void WindowsStage::compare(const FrameScene& frame,
                           const std::function<const WindowsTruth*(const WindowsRun&)>& truthFor,
                           const std::function<bool(const WindowsRun&)>& wanted,
                           const std::function<void(WindowsRun&, WindowsPicture&&)>& done) {
    renderer_.prepare(frame);
    DrawingDetail plain;
    plain.antialiasing = 0;
    const glm::ivec2 size = resolution();
    // The cars wear the same maps in all pictures, those of all that any case shows: windows are compared.
    std::vector<MirrorPlan> plans;
    std::vector<SeenVehicle> seen;
    for (const WindowsRun& run : runs_) {
        plans.push_back(planOf(run.what, frame));
        for (const SeenVehicle& v : seenBy(frame, {run.what.glass ? &plans.back() : nullptr})) {
            const auto known = std::ranges::find(seen, v.index, &SeenVehicle::index);
            if (known == seen.end())
                seen.push_back(v);
            else
                known->diameterPixels = std::max(known->diameterPixels, v.diameterPixels);
        }
    }
    ReflectionEngine& engine = *runs_.front().engine;
    ReflectionPlan maps;
    for (int i = 0; i < framesOfAge; ++i) maps = engine.update(frame, seen, renderer_);
    std::vector<glm::vec3> before;
    for (std::size_t i = 0; i < runs_.size() && !interrupted(); ++i) {
        WindowsRun& run = runs_[i];
        const PlanarReflections planar{run.what.glass ? &plans[i] : nullptr, 0,
                                       run.what.settings.wetRoad.has_value()};
        const auto picture = [&] {
            renderer_.drawView(frame.views.front(), {engine.textures(), maps.slots}, target_.framebuffer(),
                               planar);
            return readPixels(target_.framebuffer(), size);
        };
        renderer_.setDetail(plain);
        const std::vector<glm::vec3> pixels = toFloat(picture());
        renderer_.setDetail({});
        const reflection::ImageView image{size.x, size.y, pixels};
        WindowsPicture made;
        if (const WindowsTruth* truth = truthFor(run)) {
            const reflection::ImageView reference{size.x, size.y, truth->display};
            const auto errors = reflection::flip(image, reference);
            const auto on = [&](const std::vector<unsigned char>& mask, double& psnr, double& flip) {
                if (std::ranges::count(mask, 1) == 0) return;
                psnr = reflection::psnr(image, reference, mask);
                flip = reflection::meanError(errors, mask);
            };
            on(truth->glass, made.errors.psnr, made.errors.flip);
            on(truth->water, made.errors.waterPsnr, made.errors.waterFlip);
        }
        if (!before.empty()) made.errors.psnrToBefore = reflection::psnr(image, {size.x, size.y, before}, {});
        before = pixels;
        if (wanted(run)) made.seen = picture();
        done(run, std::move(made));
    }
}

}  // namespace app
