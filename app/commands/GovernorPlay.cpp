#include "app/commands/GovernorPlay.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstring>
#include <glm/common.hpp>
#include <numeric>

#include "app/commands/MirrorMask.h"
#include "app/frame/AssembleFrame.h"
#include "app/report/Timing.h"
#include "reflection/gl/SoftwareRenderer.h"
#include "reflection/truth/ImageError.h"

namespace app {

namespace {

constexpr double frameStep = 1.0 / 30;
/// Pixels around a difference in which FLIP's filters find it, at its authors' 67 pixels a degree: 10; and as
/// many again, which those read.
constexpr int reach = 10, border = 2 * reach;
/// Side of the squares of which FLIP is looked for alone.
constexpr int square = 40;

/// Mean FLIP between two pictures of the same size, looked for where they differ: runs of squares.
double jump(const Image8& from, const Image8& to) {
    const glm::ivec2 size = from.size, squares = (size + square - 1) / square;
    const std::size_t row = 4 * static_cast<std::size_t>(size.x);
    const auto at = [&](const Image8& image, int x, int y) {
        return image.rgba.data() + row * static_cast<std::size_t>(y) + 4 * static_cast<std::size_t>(x);
    };
    std::vector<bool> seen(static_cast<std::size_t>(squares.x) * static_cast<std::size_t>(squares.y));
    for (int y = 0; y < size.y; ++y) {
        if (std::memcmp(at(from, 0, y), at(to, 0, y), row) == 0) continue;
        for (int x = 0; x < size.x; ++x) {
            if (std::memcmp(at(from, x, y), at(to, x, y), 4) == 0) continue;
            const glm::ivec2 low = glm::max(glm::ivec2(x, y) - reach, glm::ivec2(0)) / square;
            const glm::ivec2 high = glm::min(glm::ivec2(x, y) + reach, size - 1) / square;
            for (int j = low.y; j <= high.y; ++j)
                for (int i = low.x; i <= high.x; ++i)
                    seen[static_cast<std::size_t>(j * squares.x + i)] = true;
        }
    }
    double sum = 0;
    for (int j = 0; j < squares.y; ++j)
        for (int i = 0; i < squares.x; ++i) {
            const int first = i;
            while (i < squares.x && seen[static_cast<std::size_t>(j * squares.x + i)]) ++i;
            if (i == first) continue;
            const glm::ivec2 low = square * glm::ivec2(first, j),
                             high = glm::min(square * glm::ivec2(i, j + 1), size);
            const glm::ivec2 corner = glm::max(low - border, glm::ivec2(0)),
                             end = glm::min(high + border, size);
            const glm::ivec2 part = end - corner;
            const auto cut = [&](const Image8& image) {
                Image8 pixels;
                pixels.size = part;
                for (int y = corner.y; y < end.y; ++y)
                    pixels.rgba.insert(pixels.rgba.end(), at(image, corner.x, y),
                                       at(image, corner.x, y) + 4 * static_cast<std::size_t>(part.x));
                return toFloat(pixels);
            };
            const std::vector<glm::vec3> a = cut(from), b = cut(to);
            const std::vector<float> flip = reflection::flip({part.x, part.y, b}, {part.x, part.y, a});
            for (int y = low.y - corner.y; y < high.y - corner.y; ++y) {
                const auto start = flip.begin() + static_cast<std::ptrdiff_t>(y) * part.x;
                sum += std::accumulate(start + (low.x - corner.x), start + (high.x - corner.x), 0.0);
            }
        }
    return sum / (static_cast<double>(size.x) * size.y);
}

}  // namespace

GovernorPlay::GovernorPlay(const Scene& scene, const PreparedReflections& prepared, SceneRenderer& renderer,
                           std::uint32_t mostCars, std::uint64_t seed, glm::ivec2 resolution,
                           const ReflectionSettings& settings, const CityMirrors& mirrors,
                           const CloseScene* close, const ChromeDrawing& chrome)
    : scene_(scene),
      renderer_(renderer),
      target_(resolution),
      set_(setCarsStage(scene, renderer, mostCars, seed, resolution)),
      engine_(*prepared.tracer, prepared.maps, scene.models, settings),
      mirrors_(mirrors),
      close_(close),
      chrome_(chrome) {
    renderer.setCloseScene(close);
    if (mirrors_.any()) renderer.setGlass(scene.glass.fronts);
}

void GovernorPlay::next(Cast& cast) {
    for (double ahead = 0; ahead < frameStep; ahead += vehicles::TrafficOptions{}.step) set_.traffic->step();
    frame_ = assembleFrame(scene_.city, *set_.traffic, scene_.lighting, {set_.view}, scene_.staged);
    cast.select(frame_, set_.view, renderer_);
}

FrameCost GovernorPlay::draw(const Detail* fixed, Governor* governor) {
    finishDrawing();
    const Stopwatch watch;
    renderer_.prepare(frame_);
    // What is seen in windows is that of the detail before; the detail follows from how much is seen.
    PlanarReflections planar =
        mirrors_.plan(set_.view, renderer_, governor != nullptr ? governor->detail() : *fixed);
    std::vector<SeenVehicle> seen;
    for (const auto& v : renderer_.visibleVehicles(set_.view, planar))
        seen.push_back({v.index, v.diameterPixels});
    const MirrorDetail before = governor != nullptr ? governor->detail().mirrors : fixed->mirrors;
    int dissolveFrames = 0;
    if (governor != nullptr) {
        governor->expect({seen.size(), renderer_.drewLast(set_.view)});
        dissolveFrames = governor->dissolveFrames();
    }
    const Detail detail = governor != nullptr ? governor->detail() : *fixed;
    if (!(detail.mirrors == before)) planar = mirrors_.plan(set_.view, renderer_, detail);
    ReflectionSettings settings = engine_.settings();
    settings.detail = detail.reflection;
    engine_.configure(settings);
    renderer_.setDetail(detail.drawing, dissolveFrames);
    const Stopwatch reflecting;
    const ReflectionPlan& plan = engine_.update(frame_, seen, renderer_);
    const double reflectionMs = reflecting.elapsed();
    ChromePlan chrome;
    if (close_ != nullptr) {
        std::vector<std::uint32_t> indices;
        for (const SeenVehicle& v : seen) indices.push_back(v.index);
        ChromePlanOptions options;
        options.leastPixels = detail.chrome.leastPixels;
        chrome = planChrome(frame_, indices, scene_.models, close_->parts, options, &fades_);
        fades_.follow(chrome);
        chrome_.bouncePixels = detail.chrome.bouncePixels;
        chromeJobs_ += chrome.jobs.size();
    }
    renderer_.drawView(set_.view, {engine_.textures(), plan.slots, 0, renewedBy(plan)}, target_.framebuffer(),
                       planar, {close_ != nullptr ? &chrome : nullptr, 0, chrome_});
    finishDrawing();
    const FrameCost cost{watch.elapsed(), reflectionMs, plan.visible, plan.texels};
    if (governor != nullptr) governor->observe(cost);
    return cost;
}

FrameCost GovernorPlay::draw(const Detail& detail) {
    return draw(&detail, nullptr);
}
FrameCost GovernorPlay::draw(Governor& governor) {
    return draw(nullptr, &governor);
}

std::vector<double> jumps(const std::vector<Image8>& pictures) {
    std::vector<double> found(pictures.empty() ? 0 : pictures.size() - 1);
    tbb::parallel_for(std::size_t{0}, found.size(),
                      [&](std::size_t i) { found[i] = jump(pictures[i], pictures[i + 1]); });
    return found;
}

}  // namespace app
