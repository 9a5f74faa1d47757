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
/// Pixels around a difference in which FLIP's filters find it.
constexpr int reach = 24;

/// Mean FLIP between two pictures of the same size, looked for where they differ.
double jump(const Image8& from, const Image8& to) {
    const glm::ivec2 size = from.size;
    glm::ivec2 low = size, high(-1);
    const std::size_t row = 4 * static_cast<std::size_t>(size.x);
    for (int y = 0; y < size.y; ++y) {
        const std::uint8_t* a = from.rgba.data() + row * static_cast<std::size_t>(y);
        const std::uint8_t* b = to.rgba.data() + row * static_cast<std::size_t>(y);
        if (std::memcmp(a, b, row) == 0) continue;
        const auto first = std::mismatch(a, a + row, b).first - a;
        auto last = static_cast<std::ptrdiff_t>(row) - 1;
        while (a[last] == b[last]) --last;
        low = glm::min(low, glm::ivec2(first / 4, y));
        high = glm::max(high, glm::ivec2(last / 4, y));
    }
    if (high.x < 0) return 0;
    low = glm::max(low - reach, glm::ivec2(0));
    high = glm::min(high + reach + 1, size);
    const auto cut = [&](const Image8& image) {
        Image8 part;
        part.size = high - low;
        for (int y = low.y; y < high.y; ++y) {
            const std::uint8_t* start =
                image.rgba.data() + row * static_cast<std::size_t>(y) + 4 * static_cast<std::size_t>(low.x);
            part.rgba.insert(part.rgba.end(), start, start + 4 * static_cast<std::size_t>(part.size.x));
        }
        return toFloat(part);
    };
    const glm::ivec2 part = high - low;
    const std::vector<glm::vec3> a = cut(from), b = cut(to);
    const std::vector<float> flip = reflection::flip({part.x, part.y, b}, {part.x, part.y, a});
    return std::accumulate(flip.begin(), flip.end(), 0.0) / (static_cast<double>(size.x) * size.y);
}

}  // namespace

GovernorPlay::GovernorPlay(const Scene& scene, const PreparedReflections& prepared, SceneRenderer& renderer,
                           std::uint32_t mostCars, std::uint64_t seed, glm::ivec2 resolution,
                           const ReflectionSettings& settings)
    : scene_(scene),
      renderer_(renderer),
      target_(resolution),
      set_(setCarsStage(scene, renderer, mostCars, seed, resolution)),
      engine_(*prepared.tracer, prepared.maps, scene.models, settings) {}

void GovernorPlay::next(Cast& cast) {
    for (double ahead = 0; ahead < frameStep; ahead += vehicles::TrafficOptions{}.step) set_.traffic->step();
    frame_ = assembleFrame(scene_.city, *set_.traffic, scene_.lighting, {set_.view});
    cast.select(frame_, set_.view, renderer_);
}

FrameCost GovernorPlay::draw(const Detail* fixed, Governor* governor) {
    finishDrawing();
    const Stopwatch watch;
    renderer_.prepare(frame_);
    const std::vector<SeenVehicle> seen = seenIn(renderer_, frame_.views);
    int dissolveFrames = 0;
    if (governor != nullptr) {
        governor->expect({seen.size(), renderer_.drewLast(set_.view)});
        dissolveFrames = governor->dissolveFrames();
    }
    const Detail detail = governor != nullptr ? governor->detail() : *fixed;
    ReflectionSettings settings = engine_.settings();
    settings.detail = detail.reflection;
    engine_.configure(settings);
    renderer_.setDetail(detail.drawing, dissolveFrames);
    const Stopwatch reflecting;
    const ReflectionPlan& plan = engine_.update(frame_, seen, renderer_);
    const double reflectionMs = reflecting.elapsed();
    renderer_.drawView(set_.view, {engine_.textures(), plan.slots}, target_.framebuffer());
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
