#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/vec3.hpp>
#include <memory>
#include <string>
#include <vector>

#include "app/mirrors/Ripples.h"
#include "city/geometry/Aabb.h"
#include "reflection/planar/ReflectionTree.h"

namespace app {

class LatheSurface;

/// Triangles with light in their corners, as radiosity leaves them: what a corner shows from every direction,
/// linear radiance, 0 .. 1.
struct LitMesh {
    struct Corner {
        glm::vec3 position{0};
        glm::vec3 normal{0, 0, 1};
        glm::vec3 colour{1};
    };
    std::vector<Corner> corners;
    std::vector<std::uint32_t> indices;  ///< three a triangle, counter-clockwise from the front

    std::size_t triangles() const { return indices.size() / 3; }
    city::Aabb bounds() const {
        city::Aabb box;
        for (const Corner& c : corners) box.extend(c.position);
        return box;
    }
};

/// A small scene of lit things, flat mirrors and curved ones: the paper's, and those that measure mirrors.
struct MirrorWorld {
    struct Flat {
        reflection::Mirror mirror;
        glm::vec3 tint{0};  ///< shown in place of what is not reflected: tint (1 - reflectance)
        Ripples ripples;
        /// Metres on which what is mirrored fades to black by 1/e; 0: it does not.
        double fade = 0;
    };
    struct Curved {
        reflection::CurvedReflector reflector;
        glm::vec3 tint{0};
        LitMesh mesh;  ///< colours unused
        /// The same surface in finer triangles, of which reflector maps are made and which rays meet; empty:
        /// `mesh` is as fine as it gets.
        LitMesh fine;
        std::shared_ptr<const LatheSurface> surface;  ///< what both are samples of; null: a ball

        const LitMesh& finest() const { return fine.corners.empty() ? mesh : fine; }
    };
    std::string name;
    std::vector<LitMesh> objects;
    std::vector<Flat> mirrors;
    std::vector<Curved> curved;
    std::vector<city::Aabb> occluders;  ///< those objects that are solid boxes
    glm::vec3 zenith{0.35f, 0.5f, 0.75f}, horizon{0.75f, 0.8f, 0.85f}, nadir{0.3f, 0.28f, 0.25f};
    /// What a mirror mirrors where the recursion ends.
    glm::vec3 beyond{0.4f};
    int depth = 2;
    glm::dvec3 eye{0}, target{1, 0, 0};
    double fovYDegrees = 60;

    std::size_t triangles() const;
    /// Whether some mirror is looked up by distances.
    bool needsDistances() const;
    reflection::TreeView view(const glm::ivec2& size) const;
    /// Radiance of the background, a unit direction: linear in its height.
    glm::vec3 sky(const glm::vec3& direction) const {
        return direction.z >= 0 ? horizon + direction.z * (zenith - horizon)
                                : horizon - direction.z * (nadir - horizon);
    }
};

/// The arrays that a ReflectionScene looks at, kept together.
struct MirrorWorldScene {
    explicit MirrorWorldScene(const MirrorWorld& world);
    reflection::ReflectionScene scene() const;

    std::vector<reflection::Mirror> mirrors;
    std::vector<reflection::CurvedReflector> curved;
    std::vector<city::Aabb> objects, occluders;
};

/// Reads a scene (data/scenes/README.md). Throws std::runtime_error with the file, the place in it, what is
/// wrong and what to do, for anything that is not exactly as described there: unknown names, missing values,
/// mirrors that are none.
MirrorWorld loadMirrorWorld(const std::filesystem::path& file);
/// The same from text; `name` stands for the file in messages.
MirrorWorld parseMirrorWorld(const std::string& text, const std::string& name);

/// A street of shop fronts, `windows` in all, on both sides of a roadway, with posts and parked boxes:
/// seeded.
MirrorWorld streetOfWindows(std::uint32_t windows, std::uint64_t seed = 1);

/// Two shop windows that face each other across an alley, and things between them. `roughness`: of both.
MirrorWorld facingWindows(float roughness);

}  // namespace app
