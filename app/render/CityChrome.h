#pragma once

#include <epoxy/gl.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <span>

#include "app/frame/ChromeDrawing.h"
#include "app/frame/ChromePlan.h"
#include "app/frame/CloseScene.h"
#include "app/frame/Lighting.h"
#include "app/render/CityMaterials.h"
#include "app/render/PassTarget.h"
#include "reflection/gl/LocalMapTextures.h"
#include "vehicles/traffic/VehiclePose.h"

namespace app {

/// Draws what chrome parts show of close things: each thing's virtual meshes (reflection/chrome), in the
/// city's and the vehicles' own shading at their true places, into an image of the view that the vehicles'
/// shader takes up at chrome's pixels. Source: Estalella et al. 2005.
class CityChrome {
  public:
    /// Keeps a reference.
    explicit CityChrome(const CloseScene& scene);
    ~CityChrome();

    struct Surroundings {
        std::span<const vehicles::VehiclePose> poses;
        /// What close vehicles' paint mirrors; null: plain paint.
        const reflection::LocalMapTextures* textures = nullptr;
        std::span<const reflection::LocalMapSlot> slots;
        /// Of these, the maps that changed since the call before; null: any may have.
        const std::vector<reflection::LocalMapSlot>* renewed = nullptr;
        Lighting lighting = {};
        /// Makes the uniform block Frame hold another eye: for what chrome that is seen in chrome shows.
        /// Empty: such chrome mirrors its vehicle's map alone.
        std::function<void(const PassView&)> setFrame = {};
    };
    /// The jobs of one of the plan's views, drawn `size` pixels large. What looks as in the call before stays
    /// as it is. The uniform block Frame must hold the view. Leaves another framebuffer bound, and
    /// setDrawState's state.
    ChromeCounts draw(const ChromePlan& plan, std::uint32_t view, const PassView& pass, glm::ivec2 size,
                      const CityMaterials& materials, const Surroundings& around,
                      const ChromeDrawing& options);
    /// A frame was drawn without: what changed in it counts for the next call.
    void skip(const std::vector<reflection::LocalMapSlot>* renewed);

    /// GL names: RGBA16F, linear radiance and its share over the local map's; reversed depth of the chrome.
    /// Valid in the pixels of vehicles that have jobs.
    std::uint32_t light() const;
    std::uint32_t depth() const;
    std::size_t bytes() const;

  private:
    struct Impl;
    explicit CityChrome(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace app
