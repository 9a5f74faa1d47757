#pragma once

#include <epoxy/gl.h>

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <memory>
#include <utility>

#include "app/render/CityChrome.h"
#include "app/render/CityPass.h"
#include "app/render/CubeDestination.h"
#include "app/render/FrameUniforms.h"
#include "app/render/GlassPass.h"
#include "app/render/NodeView.h"
#include "app/render/PaneMask.h"
#include "app/render/SceneRenderer.h"
#include "app/render/ShadowMap.h"
#include "app/render/SignalLamps.h"
#include "app/render/StandingView.h"
#include "app/render/VehiclePass.h"
#include "app/render/VehicleShadows.h"
#include "app/render/ViewSkylines.h"
#include "app/render/ViewTarget.h"
#include "reflection/gl/MirrorPass.h"
#include "reflection/gl/Texture.h"

namespace app {

namespace gl = reflection::gl;

/// Pixels for plants: where a leaf sits does not show, only how dense and how wide they are.
inline constexpr float foliageTolerance = 10;

/// Texels of about 0.12 m, as far as memory allows (8192: 128 MB).
inline int shadowSize(const city::Aabb& bounds) {
    if (bounds.empty()) return 1;
    const glm::vec3 size = bounds.size();
    int texels = 1024;
    while (texels < 8192 && static_cast<float>(texels) * 0.12f < std::max(size.x, size.y)) texels *= 2;
    return texels;
}

/// What the renderer holds: its passes and this frame's things. For SceneRenderer.cpp (views and cubes) and
/// SceneMirrors.cpp (what glass and wet ground mirror).
struct SceneRenderer::Impl {
    /// Draws reflections as the mirror pass asks for them.
    class Mirrors;
    friend class Mirrors;

    Impl(const city::CityModel& city, std::span<const vehicles::VehicleModel> models,
         const RenderOptions& renderOptions)
        : options(renderOptions),
          skylines(city, renderOptions.occlusionCulling),
          cityPass(city),
          shadow(cityPass.geometry().bounds(), shadowSize(cityPass.geometry().bounds())),
          vehiclePass(models),
          signalLamps(city.signalHeads),
          frameUniforms(gl::Buffer::create()),
          emptyArray(gl::VertexArray::create()),
          viewTarget(renderOptions.antialiasing),
          standing(city.signalHeads) {
        for (std::size_t target = 0; target < 2; ++target)
            skyPrograms[target] =
                gl::Program::fromFiles({"sky.vert", "sky.frag"}, definesFor(static_cast<PassTarget>(target)));
    }

    /// `fading`: for images of mirrors, by so much a metre behind their glass.
    void setFrame(const PassView& view, int layer = 0, float fading = 0,
                  const glm::vec4& glass = glm::vec4(0)) {
        FrameUniforms uniforms;
        uniforms.clipFromRelative = view.clipFromRelative;
        uniforms.setEye(view.eye);
        uniforms.eyeLow.w = static_cast<float>(layer);
        uniforms.setFading(fading, glass);
        uniforms.setLighting(exposed());
        uniforms.setShadow(shadow.shadowFromWorld(), shadow.normalOffset());
        frameUniforms.replaceWith(uniforms);
        glBindBufferBase(GL_UNIFORM_BUFFER, 0, frameUniforms.name());
        shadow.texture().bind(1);
    }

    /// The light, with the exposure that the viewer has adapted to.
    Lighting exposed() const {
        Lighting shown = lighting;
        shown.exposure *= adaptation;
        return shown;
    }

    void updateShadow() {
        if (!options.shadows) return;
        setDrawState();
        shadow.update(lighting.sunDirection, [&](const PassView& view) {
            setFrame(view);
            cityPass.draw(view, PassTarget::depth, foliageTolerance);
        });
    }

    /// Close things in chrome, and where the vehicles' shader finds them.
    void drawChrome(const PassView& pass, const VehicleReflections& reflections,
                    const CloseReflections& close, VehiclePass::Reflections& mirrored);

    /// The city's glass in a view whose city and vehicles are drawn.
    void drawGlass(const PassView& pass, const VehicleReflections& reflections,
                   const PlanarReflections& planar);

    void drawSky(const PassView& view, PassTarget target) {
        gl::Program& program = skyPrograms[static_cast<std::size_t>(target)];
        program.set("relativeFromClip", glm::inverse(view.clipFromRelative));
        program.use();
        emptyArray.bind();
        glDisable(GL_CULL_FACE);
        glDrawArrays(GL_TRIANGLES, 0, 3);
    }

    /// Which fronts the images below one show, by front; below a root's where there is no parent.
    const std::vector<bool>& frontsBelow(const MirrorPlan& plan, std::uint32_t root,
                                         const reflection::ReflectionNode* parent);
    /// Glass that no map serves in an image: a root's, or a node's.
    GlassPass::Counts drawPlainGlass(const PassView& pass, PassTarget target, const PlanarReflections& planar,
                                     const reflection::ReflectionNode* node);

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
    mutable ViewSkylines skylines;
    CityPass cityPass;
    ShadowMap shadow;
    VehiclePass vehiclePass;
    VehicleShadows vehicleShadows;
    SignalLamps signalLamps;
    gl::Buffer frameUniforms;
    gl::VertexArray emptyArray;
    std::array<gl::Program, 2> skyPrograms;

    ViewTarget viewTarget;
    StandingView standing;
    std::vector<city::Aabb> frontBounds, liveFronts;  ///< of the glass: all, and those that mirror now

    std::unique_ptr<GlassPass> glassPass;
    std::unique_ptr<PaneMask> paneMask;
    std::unique_ptr<reflection::MirrorPass> mirrorPass;  ///< while plans need it
    std::vector<bool> mapped;
    std::vector<std::uint32_t> fronts;

    const CloseScene* closeScene = nullptr;
    std::unique_ptr<CityChrome> cityChrome;  ///< while plans need it
    std::uint32_t framesWithoutChrome = 0;
    std::vector<std::uint32_t> withChrome;

    CubeDestination cube;

    Lighting lighting;
    float adaptation = 1;
    std::vector<vehicles::VehiclePose> poses;
    std::vector<vehicles::SignalColour> signalColours;
    std::vector<std::uint32_t> chosen;
    RenderCounters counters;
    DrawingDetail detail;
};

}  // namespace app
