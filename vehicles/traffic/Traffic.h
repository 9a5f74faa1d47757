#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "city/roads/RoadNetwork.h"
#include "vehicles/traffic/VehiclePose.h"

namespace vehicles {

/// What the simulation must know of a kind of vehicle.
struct VehicleKind {
    float length = 4.5f;  ///< metres
    float width = 1.8f;
    float wheelRadius = 0.32f;
    float wheelbase = 2.6f;
    float acceleration = 1.6f;  ///< comfortable, m/s^2
    float deceleration = 2.2f;  ///< comfortable, m/s^2, positive
    bool tram = false;          ///< drives on tram lanes only; all others on car lanes only
    float share = 1;            ///< weight when kinds are drawn for new vehicles (among their own lane kind)
};

/// Where vehicles are wanted: places on lanes within `radius` metres of `centre` are filled first, the
/// nearest first.
struct Focus {
    glm::vec3 centre{0};
    float radius = 200;
};

struct TrafficOptions {
    std::uint64_t seed = 1;
    std::uint32_t cars = 60;  ///< as many as fit are placed; `Traffic::size` says how many did
    std::uint32_t trams = 0;
    double step = 1.0 / 60;  ///< seconds, fixed; more than 1/8 s is simulated in equal parts of at most that
    std::optional<Focus> focus;
};

enum class SignalColour : std::uint8_t { red, amber, green };

/// Vehicles on a road network: car following (intelligent driver model), lane changes, signals, right of way,
/// routes drawn at random. Vehicles' boxes (length x width of their kind around their pose) do not overlap,
/// whatever the network: where ways come too close, one waits. A vehicle that has stood for 150 s before a
/// crossing that will not clear leaves, and one with a new id comes in elsewhere (in its slot of `poses`).
/// Cost of a step: linear in the vehicles, some 0.2-1 us each. The same network, kinds, options and number of
/// steps give the same poses, bit for bit.
class Traffic {
  public:
    /// Keeps a reference to the network. Throws std::invalid_argument for a step that is not finite and
    /// positive or an empty list of kinds. A network without lanes gives an empty simulation.
    Traffic(const city::RoadNetwork& roads, std::vector<VehicleKind> kinds, const TrafficOptions& options);
    ~Traffic();
    Traffic(Traffic&&) noexcept;
    Traffic& operator=(Traffic&&) noexcept;

    void step();          ///< one fixed step further
    double time() const;  ///< seconds simulated
    std::size_t size() const;
    std::size_t kindCount() const;
    std::span<const VehiclePose> poses() const;  ///< VehiclePose::model is the index of the kind
    SignalColour signal(std::uint32_t junction, std::uint32_t group) const;
    std::uint64_t stateHash() const;  ///< over all state: determinism is tested by it

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace vehicles
