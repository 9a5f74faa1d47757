#pragma once

#include <span>

#include "app/frame/FrameScene.h"
#include "app/raytrace/RayTracer.h"
#include "app/render/SceneRenderer.h"
#include "city/model/CityModel.h"
#include "reflection/gl/SoftwareRenderer.h"
#include "vehicles/models/VehicleModel.h"

namespace app::test {

/// The picture that drawn ones are to agree with: the frame's first view by rays, 16 a pixel, in the sun and
/// shadow that the renderer has, its textures as it filters them. Prepares the renderer for the frame.
inline TracedPicture tracedTruth(const city::CityModel& city, std::span<const vehicles::VehicleModel> models,
                                 const FrameScene& frame, SceneRenderer& renderer, std::uint32_t bounces) {
    RayTracer rays(city, models);
    rays.prepare(frame);
    renderer.prepare(frame);
    rays.useSunMap(renderer.sunMap());
    if (reflection::softwareRenderer()) rays.useTextureFilter(TextureFilter::llvmpipe);
    TraceOptions options;
    options.samples = 16;
    options.bounces = bounces;
    return rays.render(frame.views.front(), options);
}

}  // namespace app::test
