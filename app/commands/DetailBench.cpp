#include "app/commands/DetailBench.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <numeric>

#include "app/commands/MirrorMask.h"
#include "app/frame/ChromePlan.h"
#include "app/frame/CloseScene.h"
#include "app/report/Progress.h"
#include "app/report/Timing.h"
#include "reflection/gl/SoftwareRenderer.h"

namespace app {

namespace {

/// Whatever else runs makes frames slower, never faster: of like frames the fastest tells most. Those of
/// reflections differ, as maps are built in turns; there the middle one does.
double fastest(const std::vector<double>& values) {
    return values.empty() ? 0 : timingOf(values).min;
}
double middle(const std::vector<double>& values) {
    return values.empty() ? 0 : timingOf(values).median;
}

/// The second fastest over the fastest, less 1.
double scatterOf(std::vector<double> values) {
    if (values.size() < 2) return 0;
    std::nth_element(values.begin(), values.begin() + 1, values.end());
    const double least = *std::min_element(values.begin(), values.begin() + 1);
    return least > 0 ? values[1] / least - 1 : 0;
}

double mean(const std::vector<float>& values) {
    return values.empty()
               ? 0
               : std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

reflection::FlipImage seen(const std::vector<glm::vec3>& pixels, glm::ivec2 size) {
    return reflection::FlipImage({size.x, size.y, pixels});
}

}  // namespace

DetailBench::DetailBench(const Scene& scene, const PreparedReflections& prepared, SceneRenderer& renderer,
                         const ReflectionSettings& settings, std::span<const Clip> clips,
                         CityMirrors* mirrors, const CloseScene* close, int chromeBounces)
    : scene_(scene),
      prepared_(prepared),
      renderer_(renderer),
      settings_(settings),
      mirrors_(mirrors != nullptr && mirrors->any() ? mirrors : nullptr),
      close_(close),
      chromeBounces_(chromeBounces),
      clips_(clips),
      target_(clips.front().front().views.front().size) {
    if (mirrors_ != nullptr) full_.mirrors = mirrors_->most();
    ReflectionSettings rerendering;
    rerendering.method = ReflectionMethod::rerender;
    ReflectionEngine rerender(*prepared.tracer, prepared.maps, scene.models, rerendering);
    MirrorMask masks;
    for (const Clip& clip : clips) {
        draw(clip.back(), &rerender, full_);
        const std::vector<glm::vec3> picture = toFloat(readPixels(target_.framebuffer(), target_.size()));
        Truth& truth = truths_.emplace_back();
        truth.mask = masks.of(renderer, clip.back(), target_);
        truth.part = partOf(truth.mask);
        truth.whole = seen(picture, target_.size());
        if (truth.part.size.x > 0) truth.mirrors = seen(cut(picture, truth.part), truth.part.size);
    }
}

std::vector<DetailBench::Measured> DetailBench::measure(std::span<const Detail> details,
                                                        const std::function<bool()>& goOn) {
    struct Candidate {
        std::unique_ptr<ReflectionEngine> engine;
        std::vector<double> drawing, reflecting;  ///< of one clip, milliseconds
    };
    std::vector<Candidate> candidates(details.size());
    std::vector<Measured> found(details.size());
    for (std::size_t k = 0; k < details.size(); ++k) {
        ReflectionSettings settings = settings_;
        settings.detail = details[k].reflection;
        // They all hold maps at once.
        settings.gpuMapBytes = std::max(settings_.gpuMapBytes / details.size(), std::size_t{64} << 20);
        candidates[k].engine =
            std::make_unique<ReflectionEngine>(*prepared_.tracer, prepared_.maps, scene_.models, settings);
        found[k].rung.detail = details[k];
    }
    scatter_ = 0;
    for (const Clip& clip : clips_) {
        for (Candidate& candidate : candidates) {
            candidate.drawing.clear();
            candidate.reflecting.clear();
        }
        double scatter = 0;
        for (int round = 0; round < mostRounds; ++round) {
            for (std::size_t frame = round == 0 ? 0 : framesBefore; frame < clip.size(); ++frame) {
                for (std::size_t i = 0; i < details.size(); ++i) {
                    // Forwards and backwards: a clock that goes down must not always meet the same ones.
                    const std::size_t k = frame % 2 == 0 ? i : details.size() - 1 - i;
                    const auto [drawing, reflecting] =
                        draw(clip[frame], candidates[k].engine.get(), details[k]);
                    if (frame >= framesBefore) {
                        candidates[k].drawing.push_back(drawing);
                        candidates[k].reflecting.push_back(reflecting);
                    }
                    if (round == 0 && frame + 1 == clip.size())
                        found[k].pictures.push_back(readPixels(target_.framebuffer(), target_.size()));
                }
                if (round == 0 ? !goOn() : interrupted()) return {};
            }
            std::vector<double> scatters;
            for (const Candidate& candidate : candidates) scatters.push_back(scatterOf(candidate.drawing));
            scatter = middle(scatters);
            if (scatter <= steadyWithin) break;
        }
        scatter_ = std::max(scatter_, scatter);
        const double share = 1.0 / static_cast<double>(clips_.size());
        for (std::size_t k = 0; k < details.size(); ++k) {
            found[k].rung.drawingMs += share * fastest(candidates[k].drawing);
            found[k].rung.reflectionMs += share * middle(candidates[k].reflecting);
        }
    }
    candidates.clear();
    renderer_.setDetail({});
    constexpr std::size_t atOnce = 4;
    for (std::size_t first = 0; first < found.size(); first += atOnce) {
        const std::size_t end = std::min(first + atOnce, found.size());
        tbb::parallel_for(first, end, [&](std::size_t k) { compare(found[k]); });
        for (std::size_t k = first; k < end; ++k)
            if (!goOn()) return {};
    }
    return found;
}

VehicleCost DetailBench::vehicleCost() {
    constexpr int repeats = 6;
    VehicleCost cost;
    double more = 0;
    std::size_t fewer = 0;
    for (const Clip& clip : clips_) {
        const FrameScene& with = clip.back();
        renderer_.prepare(with);
        auto visible = renderer_.visibleVehicles(with.views.front());
        cost.vehicles += static_cast<double>(visible.size()) / static_cast<double>(clips_.size());
        // Vehicles that come and go in numbers are far away: without all but the largest.
        std::ranges::sort(visible, {}, [](const auto& v) { return v.diameterPixels; });
        visible.resize(visible.size() * 3 / 4);
        FrameScene without = with;
        for (const auto& v : visible) without.vehicles[v.index].model = ~0u;  // not drawn
        std::vector<double> all, some;
        for (int i = 0; i < repeats; ++i) {
            all.push_back(draw(with, nullptr, full_).first);
            some.push_back(draw(without, nullptr, full_).first);
        }
        more += std::max(fastest(all) - fastest(some), 0.0);
        fewer += visible.size();
    }
    cost.ms = fewer > 0 ? more / static_cast<double>(fewer) : 0;
    return cost;
}

std::pair<double, double> DetailBench::draw(const FrameScene& frame, ReflectionEngine* engine,
                                            const Detail& detail) {
    renderer_.setDetail(detail.drawing);
    finishDrawing();
    const Stopwatch watch;
    renderer_.prepare(frame);
    const View& view = frame.views.front();
    const PlanarReflections planar =
        mirrors_ != nullptr ? mirrors_->plan(view, renderer_, detail) : PlanarReflections{};
    VehicleReflections reflections;
    double reflectionMs = 0;
    if (engine != nullptr) {
        std::vector<SeenVehicle> visible;
        for (const auto& v : renderer_.visibleVehicles(view, planar))
            visible.push_back({v.index, v.diameterPixels});
        const Stopwatch reflecting;
        reflections.slots = engine->update(frame, visible, renderer_).slots;
        reflectionMs = reflecting.elapsed();
        reflections.textures = engine->textures();
    }
    ChromePlan chrome;
    if (close_ != nullptr && engine != nullptr) {
        std::vector<std::uint32_t> seen;
        for (const auto& v : renderer_.visibleVehicles(view)) seen.push_back(v.index);
        ChromePlanOptions options;
        options.leastPixels = detail.chrome.leastPixels;
        chrome = planChrome(frame, seen, scene_.models, close_->parts, options);
    }
    // Each detail pays for its own, though all draw the same frames in turn.
    ChromeDrawing anew;
    anew.keep = false;
    anew.bounces = chromeBounces_;
    anew.bouncePixels = detail.chrome.bouncePixels;
    renderer_.drawView(view, reflections, target_.framebuffer(), planar, {&chrome, 0, anew});
    finishDrawing();
    return {watch.elapsed() - reflectionMs, reflectionMs};
}

double DetailBench::jump(const Measured& from, const Measured& to) const {
    return mean(reflection::flip(seen(toFloat(to.pictures.back()), target_.size()),
                                 seen(toFloat(from.pictures.back()), target_.size())));
}

void DetailBench::compare(Measured& measured) const {
    double errors[2] = {0, 0};  // beside the mirrors, and on them
    std::size_t clips[2] = {0, 0};
    // Drawn in full, the picture differs on mirrors alone.
    const bool full = measured.rung.detail.drawing == DrawingDetail{} &&
                      (mirrors_ == nullptr || measured.rung.detail.mirrors == full_.mirrors);
    for (std::size_t clip = 0; clip < truths_.size(); ++clip) {
        const Truth& truth = truths_[clip];
        const std::vector<glm::vec3> picture = toFloat(measured.pictures[clip]);
        if (full && truth.part.size.x <= 0) continue;
        const std::vector<float> flip =
            full ? reflection::flip(seen(cut(picture, truth.part), truth.part.size), truth.mirrors)
                 : reflection::flip(seen(picture, target_.size()), truth.whole);
        std::vector<unsigned char> mask = full ? cut(truth.mask, truth.part) : truth.mask;
        for (const int mirrors : {1, 0}) {
            if (full && mirrors == 0) break;
            const double error = reflection::meanError(flip, mask);
            // Without a mirror in sight there is nothing to be wrong about.
            if (std::isfinite(error)) {
                errors[mirrors] += error;
                ++clips[mirrors];
            }
            for (unsigned char& inside : mask) inside = inside == 0;
        }
    }
    measured.rung.error = clips[1] == 0 ? 0 : errors[1] / static_cast<double>(clips[1]);
    measured.rung.pictureError = clips[0] == 0 ? 0 : errors[0] / static_cast<double>(clips[0]);
}

template <typename T>
std::vector<T> DetailBench::cut(const std::vector<T>& picture, const Part& part) const {
    std::vector<T> pixels;
    pixels.reserve(static_cast<std::size_t>(part.size.x) * static_cast<std::size_t>(part.size.y));
    for (int y = 0; y < part.size.y; ++y) {
        const auto row = picture.begin() + static_cast<std::ptrdiff_t>(part.corner.y + y) * target_.size().x +
                         part.corner.x;
        pixels.insert(pixels.end(), row, row + part.size.x);
    }
    return pixels;
}

DetailBench::Part DetailBench::partOf(const std::vector<unsigned char>& mask) const {
    constexpr int reach = 24;
    const glm::ivec2 size = target_.size();
    glm::ivec2 low = size, high(-1);
    for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x)
            if (mask[static_cast<std::size_t>(y) * static_cast<std::size_t>(size.x) +
                     static_cast<std::size_t>(x)] != 0) {
                low = glm::min(low, glm::ivec2(x, y));
                high = glm::max(high, glm::ivec2(x, y));
            }
    if (high.x < 0) return {};
    low = glm::max(low - reach, glm::ivec2(0));
    high = glm::min(high + reach, size - 1);
    return {low, high - low + 1};
}

}  // namespace app
