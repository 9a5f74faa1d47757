#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "city/geometry/Mesh.h"

namespace app {

/// How a frame is turned into glTF's (y up, right-handed, metres). A rotation: lengths and orientation stay.
using AxisTurn = glm::vec3 (*)(const glm::vec3&);

/// World east-north-up: x stays, z up becomes y, north becomes -z.
inline glm::vec3 gltfFromWorld(const glm::vec3& v) {
    return {v.x, v.z, -v.y};
}
/// Vehicle frame (x forward, y left, z up): forward becomes +z, as glTF asks of a model's front.
inline glm::vec3 gltfFromVehicle(const glm::vec3& v) {
    return {v.y, v.z, v.x};
}

/// A material in glTF's terms.
struct GltfMaterial {
    std::string name;
    glm::vec3 baseColour{1};  ///< linear
    int texture = -1;         ///< from addTexture; -1: none
    float metallic = 0;
    float roughness = 1;
    float clearCoat = 0;    ///< KHR_materials_clearcoat
    glm::vec3 emission{0};  ///< linear; factors above 1 by KHR_materials_emissive_strength
    bool twoSided = false;
    bool cutout = false;  ///< alpha below 0.5 is open
};

/// Gathers a glTF scene and writes it as one binary file. Indices are those of the order of adding.
class GltfBuilder {
  public:
    GltfBuilder();
    ~GltfBuilder();
    GltfBuilder(const GltfBuilder&) = delete;
    GltfBuilder& operator=(const GltfBuilder&) = delete;

    /// A square, repeating sRGB picture, RGBA, row 0 at v = 0; embedded as PNG. Throws std::runtime_error
    /// when it cannot be encoded.
    int addTexture(const std::string& name, int size, std::span<const std::uint8_t> rgba);
    int addMaterial(const GltfMaterial& material);
    /// One primitive for each material used; `materialOf` maps Vertex::material to an index of addMaterial.
    /// -1 for an empty mesh.
    int addMesh(const std::string& name, const city::Mesh& mesh, AxisTurn turn,
                const std::function<int(std::uint32_t)>& materialOf);
    /// A node below the scene's root, or below another node. Mesh -1: none. `transform` is in glTF's frame.
    int addNode(const std::string& name, int mesh, const glm::mat4& transform = glm::mat4(1),
                int parent = -1);

    /// Writes aside, then renames. Throws std::runtime_error naming the file and the cause, also for a scene
    /// without triangles.
    void write(const std::filesystem::path& file) const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// T M T^-1 for the world's turn: a world transform in glTF's frame.
glm::mat4 gltfFromWorldTransform(const glm::mat4& transform);

}  // namespace app
