#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "app/commands/LoadScene.h"
#include "app/frame/FrameScene.h"
#include "app/frame/ReflectionPlan.h"
#include "app/frame/View.h"
#include "app/render/SceneRenderer.h"

namespace app {

/// Traffic with enough cars in view of the best of a few lookouts down a street.
struct CarsStage {
    View view;
    std::optional<vehicles::Traffic> traffic;  ///< nothing where the city has no street to look down
    std::size_t visible = 0;
};

/// Looks for a lookout with `cars` cars in view, from a bus driver's height above a lane. Deterministic.
CarsStage setCarsStage(const Scene& scene, SceneRenderer& renderer, std::uint32_t cars, std::uint64_t seed,
                       glm::ivec2 resolution);

/// Views down the city's streets, from a bus driver's height above each lane of some length.
std::vector<View> viewsDownStreets(const city::CityModel& city, glm::ivec2 resolution);

/// The vehicles that a prepared renderer shows in these views, each once, with the greatest of its sizes.
std::vector<SeenVehicle> seenIn(const SceneRenderer& renderer, std::span<const View> views);

/// A frame in which only so many vehicles are left, those largest in the view that were kept in the
/// frame before first: nobody is swapped while he is still seen.
class Cast {
  public:
    explicit Cast(std::uint32_t count) : count_(count) {}

    /// Takes the others out of the scene; prepares the renderer with what was there before.
    void select(FrameScene& scene, const View& view, SceneRenderer& renderer);

  private:
    std::uint32_t count_;
    std::set<std::uint32_t> kept_;
};

}  // namespace app
