#include "app/commands/CompareRun.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <optional>

#include "app/commands/CarsStage.h"
#include "app/commands/MirrorMask.h"
#include "app/commands/ReflectionSource.h"
#include "app/compare/FeatureAngles.h"
#include "app/compare/PictureErrorsOf.h"
#include "app/display/OffscreenTarget.h"
#include "app/frame/AssembleFrame.h"
#include "app/frame/ToneMap.h"
#include "app/raytrace/ViewRays.h"
#include "app/render/Readback.h"
#include "app/report/Progress.h"

namespace app {

namespace {

/// What bringing maps to their age counts for in the progress bar.
constexpr std::uint32_t ageSteps = 4;
/// Of the pictures that are kept.
constexpr glm::ivec2 stripSize(640, 360);

struct ViewKind {
    std::string name;
    std::vector<View> views;
};

/// Two eyes of a viewer, 64 mm apart.
ViewKind eyesOf(const View& middle) {
    ViewKind kind{"eyes", {middle, middle}};
    const glm::dvec3 right(middle.viewFromWorld[0][0], middle.viewFromWorld[1][0],
                           middle.viewFromWorld[2][0]);
    kind.views[0].eye -= 0.032 * right;
    kind.views[1].eye += 0.032 * right;
    return kind;
}

/// A wall of two by two displays that show the view together, each with all its pixels: off-axis frusta.
ViewKind wallOf(const View& whole) {
    ViewKind kind{"four", {}};
    for (const float y : {1.0f, -1.0f})
        for (const float x : {-1.0f, 1.0f}) {
            View view = whole;
            // Of clip coordinates the quarter around (x, y) / 2 is stretched to the whole.
            view.clipFromView[0][0] *= 2;
            view.clipFromView[1][1] *= 2;
            view.clipFromView[2][0] = x;
            view.clipFromView[2][1] = y;
            kind.views.push_back(view);
        }
    return kind;
}

ReflectionSettings settingsFor(const SweepPoint& point) {
    ReflectionSettings settings;
    settings.method =
        fromName<ReflectionMethod>(reflectionMethodNames, point.method).value_or(ReflectionMethod::none);
    settings.variant = point.variant == "paper" ? MemVariant::paper : MemVariant::ours;
    settings.quality = point.quality;
    settings.detail = ReflectionDetail{point.texelBudget, point.texelsPerPixel, point.errorThreshold,
                                       point.candidates, point.lookups};
    settings.everyFrame = point.everyFrame;
    settings.parallax = point.parallax;
    settings.mapsInTurn = point.mapsInTurn;
    settings.mapsOn = MapsOn::automatic;
    if (point.faceSize > 0) {
        const auto& sizes = reflection::localMapFaceSizes;
        settings.sizeClass =
            static_cast<int>(std::find(sizes.begin(), sizes.end(), point.faceSize) - sizes.begin());
    }
    return settings;
}

/// Means over the frames in which something was measured.
class Mean {
  public:
    void add(double value) {
        if (std::isnan(value)) return;
        sum_ += value;
        ++count_;
    }
    double value() const { return count_ == 0 ? PictureErrors::unknown : sum_ / count_; }

  private:
    double sum_ = 0;
    int count_ = 0;
};

struct MeanErrors {
    Mean psnr, ssim, flip, hdrFlip, flicker;
    void add(const PictureErrors& e) {
        psnr.add(e.psnr);
        ssim.add(e.ssim);
        flip.add(e.flip);
        hdrFlip.add(e.hdrFlip);
        flicker.add(e.flicker);
    }
    PictureErrors value() const {
        return {psnr.value(), ssim.value(), flip.value(), hdrFlip.value(), flicker.value()};
    }
};

struct Contender {
    SweepPoint point;
    std::unique_ptr<ReflectionSource> source;
    std::vector<double> frameMs;
    std::vector<double> plainMs;  ///< of the same frame in plain paint, drawn just before
    double maps = 0;
    Picture now, before;
    std::vector<glm::vec3> radiance;  ///< of the last frame, where HDR-FLIP is measured
    MeanErrors againstTruth, againstRerender;
    PictureErrors last;
    double angle = PictureErrors::unknown;
};

/// One stage's run: the same cars under the same views for all contenders.
class Run {
  public:
    Run(const Scene& scene, const PreparedReflections& prepared, SceneRenderer& renderer, RayTracer& rays,
        const CompareOptions& options, const OffscreenTarget& target, CarsStage& stage, Cast& cast,
        const ViewKind& kind, std::uint32_t cars)
        : scene_(scene),
          prepared_(prepared),
          renderer_(renderer),
          rays_(rays),
          options_(options),
          target_(target),
          stage_(stage),
          cast_(cast),
          kind_(kind),
          cars_(cars) {
        for (const SweepPoint& point : comparedPoints(true)) {
            if (kind.views.size() > 1 && !point.severalViews) continue;
            Contender c;
            c.point = point;
            c.source = engineSource(scene, prepared, settingsFor(point), rays);
            contenders_.push_back(std::move(c));
        }
        errors_ = kind.views.size() == 1;
        truth_.source = tracedTruth(rays);
    }

    /// All frames, or until an interrupt.
    void measure(Progress& progress) {
        age(progress);
        for (std::uint32_t frame = 0; frame < options_.warmUp + options_.frames && !interrupted(); ++frame) {
            step(frame);
            progress.advance();
        }
    }

    void collect(std::vector<CompareRow>& rows) const;
    std::optional<PictureStrip> strip();

  private:
    void advance();
    void age(Progress& progress);
    void step(std::uint32_t frame);
    double draw(ReflectionSource& source);
    void judge(bool flickers, bool last);
    void measureAngles();
    Picture shownNow() const {
        Image8 image = readPixels(target_.framebuffer(), target_.size());
        return {image.size.x, image.size.y, std::move(image.rgba)};
    }
    std::vector<glm::vec3> radianceOf(ReflectionSource& source);
    const Contender& named(const std::string& method) const {
        return *std::find_if(contenders_.begin(), contenders_.end(),
                             [&](const auto& c) { return c.point.method == method && c.point.isDefault; });
    }

    const Scene& scene_;
    const PreparedReflections& prepared_;
    SceneRenderer& renderer_;
    RayTracer& rays_;
    const CompareOptions& options_;
    const OffscreenTarget& target_;
    CarsStage& stage_;
    Cast& cast_;
    const ViewKind& kind_;
    std::uint32_t cars_;
    bool errors_ = false;
    std::vector<Contender> contenders_;
    Contender truth_;  ///< drawn in every frame that is looked at, never timed
    FrameScene picture_;
    std::uint32_t visible_ = 0;
    MirrorMask mirrors_;
    std::vector<unsigned char> mask_, maskBefore_;
};

double Run::draw(ReflectionSource& source) {
    finishDrawing();
    const Stopwatch watch;
    renderer_.prepare(picture_);
    const std::vector<SeenVehicle> seen = seenIn(renderer_, picture_.views);
    source.beginFrame(picture_, seen, renderer_);
    // The first view last: its picture stays in the target.
    for (auto view = picture_.views.rbegin(); view != picture_.views.rend(); ++view)
        renderer_.drawView(*view, source.forView(*view, renderer_), target_.framebuffer());
    finishDrawing();
    visible_ = static_cast<std::uint32_t>(seen.size());
    return watch.elapsed();
}

/// What the last drawing shows, beyond what 8 bits hold: drawn again at several exposures.
std::vector<glm::vec3> Run::radianceOf(ReflectionSource& source) {
    const float exposure = picture_.lighting.exposure;
    std::vector<glm::vec3> radiance;
    // Rising: a pixel keeps what the longest exposure that does not saturate it says.
    for (const float factor : {1.0f / 16, 0.25f, 1.0f, 4.0f}) {
        FrameScene exposed = picture_;
        exposed.lighting.exposure = factor * exposure;
        renderer_.prepare(exposed);
        const View& view = exposed.views.front();
        renderer_.drawView(view, source.forView(view, renderer_), target_.framebuffer());
        const std::vector<glm::vec3> shown = toFloat(readPixels(target_.framebuffer(), target_.size()));
        radiance.resize(shown.size());
        for (std::size_t i = 0; i < shown.size(); ++i) {
            const float brightest = std::max({shown[i].r, shown[i].g, shown[i].b});
            if (radiance[i] == glm::vec3(0) || brightest < 0.92f)
                radiance[i] = radianceShownAs(shown[i], exposed.lighting.exposure);
        }
    }
    renderer_.prepare(picture_);
    return radiance;
}

void Run::advance() {
    for (double ahead = 0; ahead < options_.frameStep; ahead += vehicles::TrafficOptions{}.step)
        stage_.traffic->step();
    picture_ = assembleFrame(scene_.city, *stage_.traffic, scene_.lighting, kind_.views, scene_.staged);
    cast_.select(picture_, stage_.view, renderer_);
}

/// Frames in which nothing is drawn but what maps need, until maps are as old as they get: whoever rebuilds
/// one of n cars a frame shows maps up to n frames old, and must be measured so.
void Run::age(Progress& progress) {
    const auto roundsOf = [&](const Contender& c) -> std::uint32_t {
        if (c.point.mapsInTurn > 0) return std::min(cars_ / c.point.mapsInTurn + 1, 120u);
        const bool keeps = c.source->keepsMaps();
        return keeps ? 30 : 0;
    };
    std::uint32_t rounds = 0;
    for (const Contender& c : contenders_) rounds = std::max(rounds, roundsOf(c));
    for (std::uint32_t left = rounds; left > 0 && !interrupted(); --left) {
        advance();
        renderer_.prepare(picture_);
        const std::vector<SeenVehicle> seen = seenIn(renderer_, picture_.views);
        for (Contender& c : contenders_)
            if (left <= roundsOf(c)) c.source->beginFrame(picture_, seen, renderer_);
    }
    progress.advance(ageSteps);
}

void Run::step(std::uint32_t frame) {
    advance();
    const bool measured = frame >= options_.warmUp;
    // The frame before the first one measured is what its flicker is measured from.
    const bool looked = errors_ && frame + 1 >= options_.warmUp;
    const bool last = frame + 1 == options_.warmUp + options_.frames;

    // The order turns from frame to frame, so that nobody always comes behind the same one.
    Contender& plain = contenders_.front();
    const std::size_t others = contenders_.size() - 1;
    for (std::size_t k = 0; k < others; ++k) {
        Contender& c = contenders_[1 + (k + 7 * frame) % others];
        // What holds nothing from frame to frame needs no warm-up but the last.
        if (!looked && !measured && c.point.method == "rerender" && c.point.mapsInTurn == 0) continue;
        // The clock drifts: each time has its own beside it to be compared with.
        if (measured) c.plainMs.push_back(draw(*plain.source));
        const double ms = draw(*c.source);
        if (looked) {
            c.before = std::move(c.now);
            c.now = shownNow();
        }
        if (measured) {
            c.frameMs.push_back(ms);
            c.maps += c.source->mapsRebuilt();
        }
        if (last && errors_ && c.point.isDefault && !interrupted()) c.radiance = radianceOf(*c.source);
    }
    if (measured) {
        plain.plainMs.push_back(draw(*plain.source));
        plain.frameMs.push_back(plain.plainMs.back());
    }
    if (!looked) return;
    draw(*plain.source);
    plain.before = std::move(plain.now);
    plain.now = shownNow();
    if (last) plain.radiance = radianceOf(*plain.source);
    draw(*truth_.source);
    truth_.before = std::move(truth_.now);
    truth_.now = shownNow();
    if (last) truth_.radiance = radianceOf(*truth_.source);
    maskBefore_ = std::move(mask_);
    mask_ = mirrors_.of(renderer_, picture_, target_);
    if (measured) judge(maskBefore_.size() == mask_.size(), last);
}

void Run::judge(bool flickers, bool last) {
    const Contender& rerender = named("rerender");
    const ErrorWindow window(
        mask_, flickers ? std::span<const unsigned char>(maskBefore_) : std::span<const unsigned char>(),
        target_.size());
    if (window.empty()) return;
    const Judge byRerender(window, rerender.now, flickers ? &rerender.before : nullptr, rerender.radiance,
                           last);
    const Judge byTruth(window, truth_.now, flickers ? &truth_.before : nullptr, truth_.radiance, last);
    for (Contender& c : contenders_) {
        const Judged judged(window, c.now, flickers ? &c.before : nullptr, c.radiance);
        c.againstRerender.add(byRerender.errorsOf(judged));
        c.last = byTruth.errorsOf(judged);
        c.againstTruth.add(c.last);
    }
    if (last) measureAngles();
}

/// Every eighth pixel that mirrors, of the frame that was judged last.
void Run::measureAngles() {
    TraceOptions plain;
    plain.plain = true;
    const View& view = picture_.views.front();
    const TracedPicture picture = rays_.render(view, plain);
    const ViewRays through(view);
    std::vector<MirroringPoint> points;
    constexpr std::size_t step = 8;
    const auto width = static_cast<std::size_t>(picture.size.x);
    for (std::size_t i = 0; i < picture.kind.size() && i < mask_.size(); i += step) {
        if (mask_[i] == 0 || picture.kind[i] != SeenKind::vehicle) continue;
        const glm::vec3 ray = glm::normalize(
            through.through({static_cast<float>(i % width) + 0.5f, static_cast<float>(i / width) + 0.5f}));
        points.push_back({view.eye + static_cast<double>(picture.distance[i]) * glm::dvec3(ray),
                          glm::normalize(glm::reflect(ray, picture.normal[i])), picture.vehicle[i]});
    }
    // A map is asked for once.
    std::ranges::stable_sort(points, {}, &MirroringPoint::vehicle);
    std::map<std::uint32_t, std::uint32_t> indexOf;
    for (std::uint32_t i = 0; i < picture_.vehicles.size(); ++i) indexOf[picture_.vehicles[i].id] = i;
    for (Contender& c : contenders_)
        c.angle = meanFeatureAngle(
            points, [&](std::uint32_t id) { return c.source->shownMap(picture_, indexOf[id]); });
}

void Run::collect(std::vector<CompareRow>& rows) const {
    const Contender& rerender = named("rerender");
    for (const Contender& c : contenders_) {
        const std::size_t n = std::min(c.frameMs.size(), rerender.frameMs.size());
        if (n == 0) continue;
        CompareRow row;
        row.point = c.point;
        row.cars = cars_;
        row.visible = visible_;
        row.views = kind_.name;
        row.viewCount = static_cast<int>(kind_.views.size());
        row.width = options_.resolution.x;
        row.height = options_.resolution.y;
        row.frame = timingOf(c.frameMs);
        std::vector<double> extra, ratio, share;
        for (std::size_t i = 0; i < n; ++i) {
            extra.push_back(c.frameMs[i] - c.plainMs[i]);
            ratio.push_back(c.frameMs[i] / c.plainMs[i]);
            share.push_back(extra.back() / std::max(rerender.frameMs[i] - rerender.plainMs[i], 1e-3));
        }
        row.reflection = timingOf(extra);
        row.ratioToNone = timingOf(ratio).median;
        row.ratioToRerender = timingOf(share).median;
        row.mapsPerFrame = c.maps / static_cast<double>(c.frameMs.size());
        row.textureBytes = c.source->textureBytes();
        row.againstTruth = c.againstTruth.value();
        row.againstTruth.angle = c.angle;
        row.againstRerender = c.againstRerender.value();
        rows.push_back(std::move(row));
    }
}

std::optional<PictureStrip> Run::strip() {
    if (!errors_ || mask_.empty() || truth_.now.rgba.empty()) return std::nullopt;
    const glm::ivec2 size = glm::min(stripSize, target_.size());
    const glm::ivec2 corner = richestWindow(mask_, target_.size(), size);
    PictureStrip strip;
    strip.cars = cars_;
    strip.truth = cutOut(truth_.now, corner, size);
    for (const Contender& c : contenders_) {
        if (!c.point.isDefault || c.now.rgba.empty()) continue;
        PictureStrip::Frame frame;
        frame.title = c.point.title();
        frame.setting = c.point.setting;
        frame.flip = c.last.flip;
        frame.picture = cutOut(c.now, corner, size);
        frame.difference = differencePicture(frame.picture, strip.truth);
        strip.frames.push_back(std::move(frame));
    }
    return strip;
}

}  // namespace

Comparison runComparison(const Scene& scene, const PreparedReflections& prepared, SceneRenderer& renderer,
                         const CompareOptions& options) {
    Comparison comparison;
    comparison.truth = "ray traced reflections, " + std::to_string(truthTracing.samples) + " rays a pixel, " +
                       std::to_string(truthTracing.bounces) + " bounces";
    RayTracer rays(scene.city, scene.models);
    const OffscreenTarget target(options.resolution);
    constexpr std::size_t kinds = 3;
    Progress progress("frames", kinds * options.cars.size() * (ageSteps + options.frames + options.warmUp),
                      options.quiet);
    for (const std::uint32_t cars : options.cars) {
        if (interrupted()) break;
        CarsStage stage = setCarsStage(scene, renderer, cars, options.seed, options.resolution);
        if (!stage.traffic) {
            spdlog::warn("the city has no street to look down; nothing was measured for {} cars", cars);
            continue;
        }
        if (stage.visible < cars) spdlog::warn("only {} of {} cars fit on screen", stage.visible, cars);
        Cast cast(cars);
        for (const ViewKind& kind : {ViewKind{"one", {stage.view}}, eyesOf(stage.view), wallOf(stage.view)}) {
            if (interrupted()) break;
            Run run(scene, prepared, renderer, rays, options, target, stage, cast, kind, cars);
            run.measure(progress);
            run.collect(comparison.rows);
            if (options.pictures)
                if (std::optional<PictureStrip> strip = run.strip())
                    comparison.strips.push_back(std::move(*strip));
        }
    }
    markFronts(comparison.rows);
    return comparison;
}

}  // namespace app
