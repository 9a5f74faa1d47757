#pragma once

#include <filesystem>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <string>
#include <vector>

namespace vehicles {

/// One triangle of a glTF file, placed by its nodes: glTF axes, the file's units.
struct GltfTriangle {
    glm::vec3 position[3];
    glm::vec3 normal[3];
    glm::vec4 colour{1};  ///< linear base colour at the middle: factor times texel times vertex colour
    int material = -1;    ///< index into GltfScene::materials, -1: none
    int part = -1;        ///< index into GltfScene::parts
};

struct GltfMaterial {
    std::string name;
    glm::vec4 colour{1};
    float metallic = 1, roughness = 1;
    bool blended = false;  ///< alpha mode BLEND
    bool textured = false;
};

/// The triangles of one node.
struct GltfPart {
    std::string name;    ///< of the node, its mesh and the nodes above it, lower case, joined by '/'
    int wheelNode = -1;  ///< the topmost node on the way here that is called a wheel; -1: none
};

struct GltfScene {
    std::vector<GltfTriangle> triangles;
    std::vector<GltfMaterial> materials;
    std::vector<GltfPart> parts;
};

/// Reads the default scene of a binary glTF 2 file: triangles, strips and fans, indices of every type or
/// none, normals computed flat where missing. Throws std::runtime_error: one sentence with file, place, cause
/// and remedy.
GltfScene readGltf(const std::filesystem::path& file);

}  // namespace vehicles
