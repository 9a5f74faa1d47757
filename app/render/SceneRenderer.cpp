#include "app/render/SceneRenderer.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <optional>

#include "app/render/CityPass.h"
#include "app/render/CubeDestination.h"
#include "app/render/CubeFaces.h"
#include "app/render/FrameUniforms.h"
#include "app/render/ShadowMap.h"
#include "app/render/SignalLamps.h"
#include "app/render/VehiclePass.h"
#include "app/render/VehicleShadows.h"
#include "app/render/ViewTarget.h"
#include "reflection/gl/Texture.h"

namespace app {

namespace gl = reflection::gl;

namespace {

/// Beams around the eye by which hidden things are left out: 0.35 and 0.7 degrees wide.
constexpr int viewBeams = 1024;
constexpr int cubeBeams = 512;
/// Cubes are seen from inside vehicles, close to the road.
constexpr float cubeNear = 0.05f;
/// Texels by which a vehicle's level of detail may be off in a cube.
constexpr float cubeVehicleTolerance = 2.5f;
/// Pixels for plants: where a leaf sits does not show, only how dense and how wide they are.
constexpr float foliageTolerance = 10;

float pixelsPerRadian(const View& view) {
    return 0.5f * static_cast<float>(view.size.y) * std::abs(view.clipFromView[1][1]);
}

/// Texels of about 0.12 m, as far as memory allows (8192: 128 MB).
int shadowSize(const city::Aabb& bounds) {
    if (bounds.empty()) return 1;
    const glm::vec3 size = bounds.size();
    int texels = 1024;
    while (texels < 8192 && static_cast<float>(texels) * 0.12f < std::max(size.x, size.y)) texels *= 2;
    return texels;
}

void setDrawState() {
    glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    glEnable(GL_DEPTH_TEST);
    glDepthMask(GL_TRUE);
    glDepthFunc(GL_GEQUAL);
    glCullFace(GL_BACK);
    glFrontFace(GL_CCW);
    glDisable(GL_BLEND);
    glDisable(GL_SCISSOR_TEST);
    glDisable(GL_STENCIL_TEST);
    glDisable(GL_FRAMEBUFFER_SRGB);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
}

}  // namespace

struct SceneRenderer::Impl {
    Impl(const city::CityModel& city, std::span<const vehicles::VehicleModel> models,
         const RenderOptions& renderOptions)
        : options(renderOptions),
          skyline(city),
          cityPass(city),
          shadow(cityPass.geometry().bounds(), shadowSize(cityPass.geometry().bounds())),
          vehiclePass(models),
          signalLamps(city.signalHeads),
          frameUniforms(gl::Buffer::create()),
          emptyArray(gl::VertexArray::create()),
          viewTarget(renderOptions.antialiasing) {
        for (std::size_t target = 0; target < 2; ++target)
            skyPrograms[target] =
                gl::Program::fromFiles({"sky.vert", "sky.frag"}, definesFor(static_cast<PassTarget>(target)));
    }

    void setFrame(const PassView& view, int layer = 0) {
        FrameUniforms uniforms;
        uniforms.clipFromRelative = view.clipFromRelative;
        uniforms.setEye(view.eye);
        uniforms.eyeLow.w = static_cast<float>(layer);
        uniforms.setLighting(lighting);
        uniforms.setShadow(shadow.shadowFromWorld(), shadow.normalOffset());
        frameUniforms.replaceWith(uniforms);
        glBindBufferBase(GL_UNIFORM_BUFFER, 0, frameUniforms.name());
        shadow.texture().bind(1);
    }

    void updateShadow() {
        if (!options.shadows) return;
        setDrawState();
        shadow.update(lighting.sunDirection, [&](const PassView& view) {
            setFrame(view);
            cityPass.draw(view, PassTarget::depth, foliageTolerance);
        });
    }

    void drawSky(const PassView& view, PassTarget target) {
        gl::Program& program = skyPrograms[static_cast<std::size_t>(target)];
        program.set("relativeFromClip", glm::inverse(view.clipFromRelative));
        program.use();
        emptyArray.bind();
        glDisable(GL_CULL_FACE);
        glDrawArrays(GL_TRIANGLES, 0, 3);
    }

    /// What a view cannot see; the last answer is kept, as one view is asked for its vehicles before it is
    /// drawn.
    const SkylineView* skylineFor(const PassView& view) const {
        if (!options.occlusionCulling) return nullptr;
        if (!lastSkyline || lastEye != view.eye || lastClip != view.clipFromRelative) {
            lastEye = view.eye;
            lastClip = view.clipFromRelative;
            lastSkyline.emplace(skyline, view.eye, viewBeams, SkylineView::sectorOf(view.clipFromRelative));
        }
        return &*lastSkyline;
    }

    std::vector<VisibleVehicle> visible(const PassView& pass) const {
        std::vector<VisibleVehicle> found;
        for (std::uint32_t i = 0; i < poses.size(); ++i) {
            const vehicles::VehiclePose& pose = poses[i];
            if (pose.model >= vehiclePass.geometry().models().size() ||
                !pass.sees(vehiclePass.boundsOf(pose)))
                continue;
            const float radius = vehiclePass.geometry().models()[pose.model].radius;
            const float distance = std::max(glm::length(vehiclePass.centreOf(pose, pass.eye)), 0.5f * radius);
            found.push_back({i, 2 * radius / distance * pass.pixelsPerRadian});
        }
        return found;
    }

    RenderOptions options;
    Skyline skyline;
    mutable std::optional<SkylineView> lastSkyline;
    mutable glm::dvec3 lastEye{0};
    mutable glm::mat4 lastClip{0};
    CityPass cityPass;
    ShadowMap shadow;
    VehiclePass vehiclePass;
    VehicleShadows vehicleShadows;
    SignalLamps signalLamps;
    gl::Buffer frameUniforms;
    gl::VertexArray emptyArray;
    std::array<gl::Program, 2> skyPrograms;

    ViewTarget viewTarget;

    CubeDestination cube;

    Lighting lighting;
    std::vector<vehicles::VehiclePose> poses;
    std::vector<vehicles::SignalColour> signalColours;
    std::vector<std::uint32_t> chosen;
    RenderCounters counters;
    DrawingDetail detail;
};

SceneRenderer::SceneRenderer(const city::CityModel& city, std::span<const vehicles::VehicleModel> models,
                             const RenderOptions& options)
    : impl_(std::make_unique<Impl>(city, models, options)) {}

SceneRenderer::~SceneRenderer() = default;

void SceneRenderer::prepare(const FrameScene& scene) {
    impl_->lighting = scene.lighting;
    const float length = glm::length(scene.lighting.sunDirection);
    impl_->lighting.sunDirection = length > 0 ? scene.lighting.sunDirection / length : glm::vec3(0, 0, 1);
    impl_->poses = scene.vehicles;
    impl_->signalColours = scene.signalColours;
}

void SceneRenderer::setDetail(const DrawingDetail& detail) {
    impl_->detail = detail;
}

void SceneRenderer::drawView(const View& view, const VehicleReflections& reflections,
                             std::uint32_t framebuffer) {
    Impl& my = *impl_;
    my.counters = {};
    if (view.size.x <= 0 || view.size.y <= 0) return;
    my.updateShadow();
    setDrawState();
    my.viewTarget.begin(view.size, my.detail.scale);
    const float drawnShare = static_cast<float>(my.viewTarget.drawn().y) / static_cast<float>(view.size.y);
    PassView pass(view.eye, view.clipFromView * view.viewFromWorld, drawnShare * pixelsPerRadian(view));
    pass.skyline = my.skylineFor(pass);
    my.setFrame(pass);

    my.chosen.clear();
    for (const VisibleVehicle& v : my.visible(pass)) my.chosen.push_back(v.index);
    const VehiclePass::Counts vehicles =
        my.vehiclePass.draw(pass, PassTarget::view, my.poses, my.chosen,
                            {&reflections.textures, reflections.slots, reflections.mirrored},
                            static_cast<float>(my.detail.vehicleTolerance));
    const CityPass::Counts city = my.cityPass.draw(pass, PassTarget::view, foliageTolerance);
    const std::uint32_t lampCalls = my.signalLamps.draw(pass, PassTarget::view, my.signalColours);
    const std::uint32_t shadowCalls =
        my.options.shadows ? my.vehicleShadows.draw(pass, my.vehiclePass.geometry(), my.poses, my.chosen) : 0;
    my.drawSky(pass, PassTarget::view);

    my.viewTarget.finish(framebuffer, my.detail.antialiasing);

    my.counters.drawCalls = vehicles.drawCalls + city.drawCalls + lampCalls + shadowCalls + 1;
    my.counters.triangles = vehicles.triangles + city.triangles;
    my.counters.chunksDrawn = city.chunksDrawn;
    my.counters.chunksCulled = city.chunksCulled;
    my.counters.vehiclesDrawn = vehicles.vehicles;
}

void SceneRenderer::drawCube(const glm::dvec3& centre, const reflection::CubeTarget& target,
                             const reflection::CubeContent& content) {
    Impl& my = *impl_;
    if (target.colour == 0 || target.faceSize <= 0) return;
    my.updateShadow();
    setDrawState();
    my.cube.begin(target);
    std::optional<SkylineView> skyline;
    if (my.options.occlusionCulling) skyline.emplace(my.skyline, centre, cubeBeams, SkylineView::Sector{});
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
    pass.skyline = my.skylineFor(pass);
    return my.visible(pass);
}

}  // namespace app
