#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/mirrors/MirrorWorld.h"
#include "city/geometry/Mesh.h"
#include "reflection/chrome/ReflectorPieces.h"
#include "reflection/planar/ReflectionTree.h"

namespace app {

/// Corners that differ in no more than normal or colour, as one vertex: what searches are for.
struct CloseMesh {
    std::vector<glm::vec3> positions;
    std::vector<std::uint32_t> indices;
    float distance = 0;  ///< metres, of its box from the reflector's centre
};
CloseMesh welded(const LitMesh& mesh);

/// A reflector of a scene, ready for searches, and what stands close to it. World frame.
struct StagedChrome {
    std::string name;
    const MirrorWorld::Curved* mirror = nullptr;
    reflection::Reflector reflector;
    std::vector<CloseMesh> close;  ///< nearest first
    /// Whether searches on it look for all points, which takes a hundred times as long.
    bool concave() const {
        for (const reflection::ReflectorPiece& p : reflector.pieces)
            if (p.bend == reflection::Bend::concave) return true;
        return false;
    }
};

/// A scene's curved reflectors with their maps. Keeps a reference to the world.
struct ChromeStage {
    /// `reach`: radii of a reflector's ball around it within which things are close to it.
    explicit ChromeStage(const MirrorWorld& scene, double reach = 12);

    const MirrorWorld& world;
    std::vector<StagedChrome> parts;
};

/// Where a view shows directions from its eye.
class PixelPlace {
  public:
    explicit PixelPlace(const reflection::TreeView& view) : view_(view) {}
    /// Pixels from the upper left corner; far outside where it lies behind the eye.
    glm::dvec2 of(const glm::dvec3& fromEye) const;
    bool inside(const glm::dvec2& pixel) const;

  private:
    reflection::TreeView view_;
};

/// A distribution's figures. Empty: zeros.
struct Spread {
    std::size_t n = 0;
    double mean = 0, p99 = 0, worst = 0;
};
Spread spreadOf(std::vector<double> values);
/// {"n", "mean", "p99", "worst"}.
nlohmann::ordered_json toJson(const Spread& spread);

}  // namespace app
