#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "city/geodesy/LocalFrame.h"
#include "city/geometry/Aabb.h"
#include "city/geometry/Mesh.h"
#include "city/model/Material.h"
#include "city/model/StandingReflector.h"
#include "city/roads/RoadNetwork.h"

namespace city {

/// Furniture juts out or hangs (awnings, balconies, signs) and is no column of the heightfield.
enum class ChunkKind : std::uint8_t { ground, building, furniture };

/// A piece of the city that is drawn and culled as one: at most about a block, already in world coordinates.
struct Chunk {
    ChunkKind kind = ChunkKind::building;
    Mesh mesh;
    Aabb bounds;
};

/// A thing that stands in the city many times (a tree, a lamp). Levels from finest to coarsest, in the
/// prototype's own frame: origin at its foot, z up, metres.
struct Prototype {
    struct Level {
        Mesh mesh;
        float error = 0;  ///< metres by which the level may differ from level 0
    };
    std::string name;
    std::vector<Level> levels;
    bool inHeightfield =
        true;  ///< false for what is too thin to be a column of the heightfield (poles, wires)
};

struct Placement {
    std::uint32_t prototype = 0;
    glm::mat4 worldFromPrototype{1};
};

/// Where a car signal head hangs, for drawing its state.
struct SignalHead {
    glm::vec3 position{0};
    glm::vec3 facing{1, 0, 0};  ///< unit, towards the drivers it speaks to
    std::uint32_t junction = noIndex;
    std::uint32_t signalGroup = noIndex;
};

/// Guided tour through the city: the camera moves along the points at walking-to-driving pace.
struct TourStop {
    glm::vec3 eye{0};
    glm::vec3 target{1, 0, 0};
    float time = 0;  ///< seconds from the start of the tour
};

/// The static world: everything that stands still. Pure data. World frame: right-handed, x east, y north, z
/// up, metres, near the origin.
struct CityModel {
    std::string name;
    Aabb bounds;
    std::vector<Material> materials;
    std::vector<Chunk> chunks;
    std::vector<Prototype> prototypes;
    std::vector<Placement> placements;
    std::vector<StandingReflector> reflectors;  ///< mirrors that stand in it
    RoadNetwork roads;
    std::vector<SignalHead> signalHeads;
    std::vector<TourStop> tour;       ///< may be empty: the program then plans one along the lanes
    std::optional<LocalFrame> frame;  ///< set where the city has a place on Earth
    std::vector<std::string> notes;   ///< what an importer dropped or guessed, one sentence with a count each

    std::size_t triangleCount() const;  ///< all placements at their finest level
    /// 64-bit hash over everything that can be seen in a reference map (of standing reflectors their
    /// shadows): equal content, equal hash, on every
    /// machine.
    std::uint64_t contentHash() const;
};

}  // namespace city
