#include "app/render/SceneRenderer.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <optional>

#include "app/render/CubeFaces.h"
#include "app/render/SceneRendererImpl.h"

namespace app {

namespace {

/// Beams around the eye by which hidden things are left out: 0.7 degrees wide.
constexpr int cubeBeams = 512;
/// Cubes are seen from inside vehicles, close to the road.
constexpr float cubeNear = 0.05f;
/// Texels by which a vehicle's level of detail may be off in a cube.
constexpr float cubeVehicleTolerance = 2.5f;

float pixelsPerRadian(const View& view) {
    return 0.5f * static_cast<float>(view.size.y) * std::abs(view.clipFromView[1][1]);
}

}  // namespace

SceneRenderer::SceneRenderer(const city::CityModel& city, std::span<const vehicles::VehicleModel> models,
                             const RenderOptions& options)
    : impl_(std::make_unique<Impl>(city, models, options)) {}

SceneRenderer::~SceneRenderer() = default;

void SceneRenderer::prepare(const FrameScene& scene) {
    impl_->lighting = scene.lighting;
    impl_->adaptation = static_cast<float>(scene.adaptation);
    const float length = glm::length(scene.lighting.sunDirection);
    impl_->lighting.sunDirection = length > 0 ? scene.lighting.sunDirection / length : glm::vec3(0, 0, 1);
    impl_->poses = scene.vehicles;
    impl_->signalColours = scene.signalColours;
    impl_->skylines.beginFrame();
}

void SceneRenderer::setGlass(std::span<const city::GlassFront> fronts) {
    impl_->glassPass = fronts.empty() ? nullptr : std::make_unique<GlassPass>(fronts);
    impl_->paneMask = fronts.empty() ? nullptr : std::make_unique<PaneMask>(fronts);
    impl_->frontBounds.clear();
    for (const city::GlassFront& front : fronts) impl_->frontBounds.push_back(front.bounds);
}

bool SceneRenderer::hides(const reflection::EyeView& from, const reflection::HalfSpace* glass,
                          const city::Aabb& box) const {
    const SkylineView* skyline = impl_->skylines.through(from, glass);
    return skyline != nullptr && skyline->hides(box);
}

void SceneRenderer::setDetail(const DrawingDetail& detail, int dissolveFrames) {
    impl_->detail = detail;
    impl_->standing.dissolveNext(dissolveFrames);
}

void SceneRenderer::prepareForChanges(glm::ivec2 size) {
    setDrawState();
    impl_->viewTarget.prepareDissolving(size);
    impl_->standing.forget();
}

bool SceneRenderer::drewLast(const View& view) const {
    return impl_->standing.drewLast({view.eye, view.clipFromView * view.viewFromWorld, 1}, view.size,
                                    impl_->exposed());
}

void SceneRenderer::drawView(const View& view, const VehicleReflections& reflections,
                             std::uint32_t framebuffer, const PlanarReflections& planar,
                             const CloseReflections& close) {
    Impl& my = *impl_;
    my.counters = {};
    if (view.size.x <= 0 || view.size.y <= 0) return;
    my.updateShadow();
    setDrawState();
    my.standing.begin({view.eye, view.clipFromView * view.viewFromWorld, 1}, view.size, my.exposed(),
                      my.viewTarget);
    my.viewTarget.begin(view.size, my.detail.scale);
    const float drawnShare = static_cast<float>(my.viewTarget.drawn().y) / static_cast<float>(view.size.y);
    PassView pass(view.eye, view.clipFromView * view.viewFromWorld, drawnShare * pixelsPerRadian(view));
    pass.skyline = my.skylines.of(pass);
    my.liveFronts.clear();
    if (planar.plan != nullptr) {
        const std::vector<bool>& mirrors = my.frontsBelow(*planar.plan, planar.root, nullptr);
        for (std::size_t i = 0; i < std::min(mirrors.size(), my.frontBounds.size()); ++i)
            if (mirrors[i]) my.liveFronts.push_back(my.frontBounds[i]);
    }
    my.standing.show(
        pass, my.poses, my.signalColours,
        [&](const vehicles::VehiclePose& pose) { return my.vehiclePass.boundsOf(pose); }, my.liveFronts,
        my.viewTarget);
    my.setFrame(pass);

    VehiclePass::Reflections mirrored{
        &reflections.textures, reflections.slots, reflections.mirrored, 0, 0, {}};
    my.drawChrome(pass, reflections, close, mirrored);
    my.chosen.clear();
    for (const VisibleVehicle& v : my.visible(pass)) my.chosen.push_back(v.index);
    const VehiclePass::Counts vehicles =
        my.vehiclePass.draw(pass, PassTarget::view, my.poses, my.chosen, mirrored,
                            static_cast<float>(my.detail.vehicleTolerance));
    const CityPass::Counts city = my.cityPass.draw(pass, PassTarget::view, foliageTolerance);
    const std::uint32_t lampCalls = my.signalLamps.draw(pass, PassTarget::view, my.signalColours);
    my.drawGlass(pass, reflections, planar);
    const std::uint32_t shadowCalls =
        my.options.shadows ? my.vehicleShadows.draw(pass, my.vehiclePass.geometry(), my.poses, my.chosen) : 0;
    my.drawSky(pass, PassTarget::view);

    my.viewTarget.finish(framebuffer, my.detail.antialiasing);

    my.counters.drawCalls += vehicles.drawCalls + city.drawCalls + lampCalls + shadowCalls + 1;
    my.counters.triangles += vehicles.triangles + city.triangles;
    my.counters.chunksDrawn = city.chunksDrawn;
    my.counters.chunksCulled = city.chunksCulled;
    my.counters.vehiclesDrawn = vehicles.vehicles;
}

void SceneRenderer::setCloseScene(const CloseScene* scene) {
    impl_->closeScene = scene;
    impl_->cityChrome.reset();
}

void SceneRenderer::Impl::drawChrome(const PassView& pass, const VehicleReflections& reflections,
                                     const CloseReflections& close, VehiclePass::Reflections& mirrored) {
    withChrome.clear();
    if (close.plan != nullptr && closeScene != nullptr && reflections.mirrored == 0)
        for (const ChromeJob& job : close.plan->jobs)
            if (job.view == close.view && job.vehicle < poses.size()) withChrome.push_back(job.vehicle);
    if (withChrome.empty()) {
        constexpr std::uint32_t patience = 60;
        if (cityChrome) cityChrome->skip(reflections.renewed ? &*reflections.renewed : nullptr);
        if (cityChrome && ++framesWithoutChrome > patience) cityChrome.reset();
        return;
    }
    framesWithoutChrome = 0;
    std::ranges::sort(withChrome);
    if (!cityChrome) cityChrome = std::make_unique<CityChrome>(*closeScene);
    counters.chrome =
        cityChrome->draw(*close.plan, close.view, pass, viewTarget.drawn(), cityPass.materials(),
                         {poses, &reflections.textures, reflections.slots,
                          reflections.renewed ? &*reflections.renewed : nullptr, lighting,
                          [this](const PassView& from) { setFrame(from); }},
                         close.drawing);
    counters.chromeTextureBytes = cityChrome->bytes();
    mirrored.closeLight = cityChrome->light();
    mirrored.closeDepth = cityChrome->depth();
    mirrored.withChrome = withChrome;
    glBindFramebuffer(GL_FRAMEBUFFER, viewTarget.framebuffer());
    glViewport(0, 0, viewTarget.drawn().x, viewTarget.drawn().y);
}

void SceneRenderer::drawCube(const glm::dvec3& centre, const reflection::CubeTarget& target,
                             const reflection::CubeContent& content) {
    Impl& my = *impl_;
    if (target.colour == 0 || target.faceSize <= 0) return;
    my.updateShadow();
    setDrawState();
    my.cube.begin(target);
    std::optional<SkylineView> skyline;
    if (my.options.occlusionCulling)
        skyline.emplace(my.skylines.skyline(), centre, cubeBeams, SkylineView::Sector{});
    for (int face = 0; face < 6; ++face) {
        my.cube.selectFace(face);
        PassView pass(centre, clipFromCubeFace(face, cubeNear), 0.5f * static_cast<float>(target.faceSize));
        pass.skyline = skyline ? &*skyline : nullptr;
        my.setFrame(pass, face);
        if (content.vehicles) {
            my.chosen.clear();
            for (std::uint32_t i = 0; i < my.poses.size(); ++i) {
                const vehicles::VehiclePose& pose = my.poses[i];
                if (pose.id == content.excludedVehicle ||
                    pose.model >= my.vehiclePass.geometry().models().size())
                    continue;
                if (pass.sees(my.vehiclePass.boundsOf(pose))) my.chosen.push_back(i);
            }
            my.vehiclePass.draw(pass, PassTarget::cube, my.poses, my.chosen, {}, cubeVehicleTolerance);
        }
        if (content.city) my.cityPass.draw(pass, PassTarget::cube, foliageTolerance);
        if (content.vehicles) my.signalLamps.draw(pass, PassTarget::cube, my.signalColours);
        my.drawSky(pass, PassTarget::cube);
    }
}

std::shared_ptr<const SunMap> SceneRenderer::sunMap() {
    impl_->updateShadow();
    return impl_->options.shadows ? impl_->shadow.read() : std::make_shared<const SunMap>();
}

const RenderCounters& SceneRenderer::counters() const {
    return impl_->counters;
}

std::vector<SceneRenderer::VisibleVehicle> SceneRenderer::visibleVehicles(const View& view) const {
    const Impl& my = *impl_;
    PassView pass(view.eye, view.clipFromView * view.viewFromWorld, pixelsPerRadian(view));
    pass.skyline = my.skylines.of(pass);
    return my.visible(pass);
}

std::vector<SceneRenderer::VisibleVehicle> SceneRenderer::visibleVehicles(
    const View& view, const PlanarReflections& planar) const {
    const Impl& my = *impl_;
    std::vector<VisibleVehicle> found = visibleVehicles(view);
    if (planar.plan == nullptr) return found;
    constexpr std::uint32_t unseen = 0xffffffffu;
    std::vector<std::uint32_t> place(my.poses.size(), unseen);
    for (std::uint32_t i = 0; i < found.size(); ++i) place[found[i].index] = i;
    for (const reflection::ReflectionNode& node : planar.plan->tree.nodes) {
        if (node.root != planar.root) continue;
        PassView pass = passOf(node, 0.5f);
        pass.skyline = my.skylines.through(node.view, &node.glass);
        for (const VisibleVehicle& v : my.visible(pass)) {
            if (place[v.index] == unseen) {
                place[v.index] = static_cast<std::uint32_t>(found.size());
                found.push_back(v);
            } else {
                float& most = found[place[v.index]].diameterPixels;
                most = std::max(most, v.diameterPixels);
            }
        }
    }
    return found;
}

}  // namespace app
