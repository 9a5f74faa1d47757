#include "app/frame/MirrorPlan.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace app {

namespace {

/// A front that may be given to the tree.
struct Candidate {
    std::uint32_t front;
    double size;  ///< pixels of glass, or what they would be were it in view
};

bool finite(const View& view) {
    return std::isfinite(view.eye.x) && std::isfinite(view.eye.y) && std::isfinite(view.eye.z) &&
           view.size.x > 0 && view.size.y > 0;
}

double distanceTo(const city::Aabb& box, const glm::dvec3& eye) {
    const glm::dvec3 nearest = glm::clamp(eye, glm::dvec3(box.min), glm::dvec3(box.max));
    return glm::length(eye - nearest);
}

/// Keeps the largest, in a fixed order.
void keepLargest(std::vector<Candidate>& candidates, std::size_t most) {
    std::ranges::sort(candidates, [](const Candidate& a, const Candidate& b) {
        return a.size != b.size ? a.size > b.size : a.front < b.front;
    });
    if (candidates.size() > most) candidates.resize(most);
}

}  // namespace

reflection::EyeView eyeViewOf(const View& view) {
    reflection::EyeView eye;
    eye.eye = view.eye;
    eye.viewFromWorld = glm::dmat3(glm::mat3(view.viewFromWorld));
    eye.clipFromView = glm::dmat4(view.clipFromView);
    return eye;
}

void MirrorSettings::limit(const Detail& detail) {
    const auto whole = [](double most) { return std::max(std::round(most), 0.0); };
    maps = static_cast<std::uint32_t>(std::min(static_cast<double>(maps), whole(detail.mirrors.maps)));
    depth = static_cast<int>(std::min(static_cast<double>(depth), whole(detail.mirrors.depth)));
    texels *= detail.mirrors.texels * detail.drawing.scale;
}

MirrorPlanner::MirrorPlanner(std::span<const city::GlassFront> fronts) {
    for (std::uint32_t i = 0; i < fronts.size(); ++i) {
        const city::GlassFront& front = fronts[i];
        reflection::MirrorResult made = reflection::MirrorPlane::make(
            front.outline, {glm::vec3(front.glass.reflectance), front.glass.roughness});
        // What GlassFronts lists has an area and is flat to single precision; anything else mirrors nothing.
        if (made.status != reflection::MirrorStatus::ok) continue;
        fronts_.push_back({i, static_cast<std::uint32_t>(front.paneCount), front.area, front.bounds,
                           std::move(made.mirror)});
    }
}

MirrorPlan MirrorPlanner::plan(std::span<const View> views, const MirrorSettings& settings,
                               const Hidden& hidden) const {
    const auto start = std::chrono::steady_clock::now();
    MirrorPlan plan;
    plan.fade = std::isfinite(settings.fade) ? std::max(settings.fade, 0.0) : 0.0;
    MirrorCounters& counters = plan.counters;
    counters.inCity = static_cast<std::uint32_t>(fronts_.size());
    const bool sound = std::ranges::all_of(views, finite);
    if (!settings.on || settings.depth <= 0 || settings.maps == 0 || !sound) return plan;

    std::vector<reflection::TreeView> eyes;
    std::vector<reflection::HalfSpaces> frustums;
    for (const View& view : views) {
        eyes.push_back({eyeViewOf(view), view.size});
        frustums.push_back(reflection::frustumOf(eyes.back().view));
    }
    std::vector<Candidate> direct, behindOthers;
    for (std::uint32_t f = 0; f < fronts_.size(); ++f) {
        const Front& front = fronts_[f];
        const glm::dvec3 low(front.bounds.min), high(front.bounds.max);
        double pixels = 0, whole = 0;
        for (std::size_t v = 0; v < views.size(); ++v) {
            const glm::dvec3 eye = views[v].eye;
            const double distance = std::max(distanceTo(front.bounds, eye), 0.5);
            if (distance > settings.reach) continue;
            const double perRadian = 0.5 * views[v].size.y * std::abs(double(views[v].clipFromView[1][1]));
            const double straight = front.area / (distance * distance) * perRadian * perRadian;
            whole = std::max(whole, straight);
            const double before = front.plane.signedDistance(eye);
            if (before <= 0) continue;
            if (!reflection::touches(frustums[v], 0.5 * (low + high) - eye, 0.5 * (high - low))) continue;
            pixels = std::max(pixels, straight * std::min(1.0, before / distance));
        }
        if (whole <= 0) continue;
        ++counters.inReach;
        const bool rough = front.rough();
        if (pixels >= (rough ? settings.leastRoughPixels : settings.leastPixels)) {
            ++counters.inView;
            direct.push_back({f, pixels});
        } else if (!rough && settings.depth > 1 && whole >= settings.leastPixels) {
            behindOthers.push_back({f, whole});
        }
    }
    const auto finish = [&] {
        counters.milliseconds =
            std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    };
    std::optional<reflection::MirrorPlane> road;
    if (settings.wetRoad && std::isfinite(*settings.wetRoad)) {
        const glm::dvec3 eye = views.front().eye;
        const double r = settings.reach, z = *settings.wetRoad;
        const std::array<glm::dvec3, 4> square{glm::dvec3(eye.x - r, eye.y - r, z),
                                               {eye.x + r, eye.y - r, z},
                                               {eye.x + r, eye.y + r, z},
                                               {eye.x - r, eye.y + r, z}};
        // Seen at a low angle water mirrors as much as a third: what is planned for.
        reflection::MirrorResult made =
            reflection::MirrorPlane::make(square, {glm::vec3(0.3f), wetRoughness});
        if (made.status == reflection::MirrorStatus::ok) road = std::move(made.mirror);
    }
    if (direct.empty() && !road) {
        finish();
        return plan;
    }
    keepLargest(direct, settings.mostFronts);
    keepLargest(behindOthers, settings.mostFronts - direct.size());

    std::vector<reflection::Mirror> mirrors;
    const auto give = [&](const std::vector<Candidate>& some) {
        for (const Candidate& c : some) {
            const Front& front = fronts_[c.front];
            mirrors.push_back({c.front, front.plane});
            mirrors.back().texels = settings.texels * (front.rough() ? roughTexels : 1);
            plan.fronts.push_back(fronts_[c.front].index);
        }
    };
    give(direct);
    give(behindOthers);
    if (road) {
        mirrors.push_back({MirrorPlan::road, *road});
        mirrors.back().texels = wetTexels * settings.texels;
        plan.fronts.push_back(MirrorPlan::road);
    }
    const std::uint32_t groups = reflection::groupCoplanar(mirrors);
    // Rough fronts want few texels and much around them, panes many and nothing else: a view for each.
    for (reflection::Mirror& m : mirrors)
        if (m.group != reflection::Mirror::alone && m.plane.surface().roughness > 0) m.group += groups;

    reflection::ReflectionScene scene;
    scene.mirrors = mirrors;
    if (hidden)
        scene.hidden = [&](const reflection::EyeView& from, const reflection::HalfSpace* glass,
                           const reflection::Mirror& mirror) {
            return mirror.id != MirrorPlan::road && hidden(from, glass, fronts_[mirror.id].bounds);
        };
    reflection::TreeSettings tree;
    tree.depth = settings.depth;
    tree.economies = settings.economies;
    tree.mostMaps = settings.maps;
    if (road)
        tree.cutOff = wetCutOff;
    else if (std::ranges::any_of(direct, [&](const Candidate& c) { return fronts_[c.front].rough(); }))
        tree.cutOff = roughCutOff;
    tree.leastPixels = settings.leastPixels;
    tree.leastLight = leastLight;
    tree.levelScale = settings.levelScale;
    plan.tree = reflection::reflectionTree(eyes, scene, tree);

    std::vector<bool> shown(mirrors.size(), false);
    for (const std::uint32_t m : plan.tree.mirrors) shown[m] = true;
    for (std::size_t m = 0; m < mirrors.size(); ++m) {
        if (!shown[m]) continue;
        if (mirrors[m].id == MirrorPlan::road) {
            counters.road = true;
            continue;
        }
        ++counters.shown;
        counters.windows += fronts_[mirrors[m].id].panes;
        counters.rough += mirrors[m].plane.surface().roughness > 0;
    }
    const reflection::TreeCounters& t = plan.tree.counters;
    counters.passes = t.generated();
    counters.levels = t.deepest;
    counters.texels = t.texels;
    counters.shared = t.shared;
    counters.occluded = t.occluded;
    counters.backFacing = t.backFacing;
    counters.offScreen = t.offScreen;
    counters.belowCutOff = t.belowCutOff;
    counters.overCap = t.overCap;
    finish();
    return plan;
}

}  // namespace app
