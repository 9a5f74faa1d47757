#include "app/export/GltfBuilder.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <tiny_gltf.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <stdexcept>
#include <system_error>

#include "app/report/AsideFile.h"

namespace app {

namespace {

constexpr std::uint32_t unused = 0xffffffffu;

std::vector<unsigned char> encodePng(const std::string& name, int size, std::span<const std::uint8_t> rgba) {
    if (size < 1 || rgba.size() != static_cast<std::size_t>(size) * static_cast<std::size_t>(size) * 4)
        throw std::runtime_error("the picture '" + name + "' has no pixels to export.");
    // Opaque pictures are stored without alpha: half the readers treat an alpha channel as blending.
    bool opaque = true;
    for (std::size_t i = 3; i < rgba.size(); i += 4) opaque = opaque && rgba[i] == 255;
    std::vector<unsigned char> bytes;
    OIIO::Filesystem::IOVecOutput memory(bytes);
    auto output = OIIO::ImageOutput::create("png");
    OIIO::ImageSpec spec(size, size, opaque ? 3 : 4, OIIO::TypeDesc::UINT8);
    spec.attribute("oiio:ColorSpace", "sRGB");
    spec.attribute("oiio:UnassociatedAlpha", 1);
    if (!output || !output->set_ioproxy(&memory) || !output->open(name + ".png", spec) ||
        !output->write_image(OIIO::TypeDesc::UINT8, rgba.data(), 4) || !output->close())
        throw std::runtime_error("cannot encode the picture '" + name + "' as PNG (" +
                                 (output ? output->geterror() : OIIO::geterror()) +
                                 "); reinstall OpenImageIO.");
    return bytes;
}

tinygltf::Value numberObject(const std::string& key, double value) {
    tinygltf::Value::Object object;
    object[key] = tinygltf::Value(value);
    return tinygltf::Value(object);
}

/// Vertices of one material of a mesh, numbered anew.
struct Part {
    std::vector<float> positions;
    std::vector<float> normals;
    std::vector<float> texcoords;
    std::vector<std::uint32_t> indices;
    std::vector<double> low{1e30, 1e30, 1e30};
    std::vector<double> high{-1e30, -1e30, -1e30};
};

}  // namespace

struct GltfBuilder::Impl {
    tinygltf::Model model;
    std::size_t triangles = 0;

    /// Appends bytes, aligned to four, as a buffer view.
    template <class T>
    int view(std::span<const T> data, int target) {
        std::vector<unsigned char>& bytes = model.buffers[0].data;
        bytes.resize((bytes.size() + 3) / 4 * 4);
        tinygltf::BufferView view;
        view.buffer = 0;
        view.byteOffset = bytes.size();
        view.byteLength = data.size_bytes();
        view.target = target;
        bytes.resize(bytes.size() + data.size_bytes());
        std::memcpy(bytes.data() + view.byteOffset, data.data(), data.size_bytes());
        model.bufferViews.push_back(view);
        return static_cast<int>(model.bufferViews.size()) - 1;
    }
    int accessor(int bufferView, int componentType, int type, std::size_t count) {
        tinygltf::Accessor accessor;
        accessor.bufferView = bufferView;
        accessor.componentType = componentType;
        accessor.type = type;
        accessor.count = count;
        model.accessors.push_back(accessor);
        return static_cast<int>(model.accessors.size()) - 1;
    }
    int floats(const std::vector<float>& values, int type, std::size_t components) {
        return accessor(view(std::span<const float>(values), TINYGLTF_TARGET_ARRAY_BUFFER),
                        TINYGLTF_COMPONENT_TYPE_FLOAT, type, values.size() / components);
    }
    void use(const std::string& extension) {
        auto& used = model.extensionsUsed;
        if (std::find(used.begin(), used.end(), extension) == used.end()) used.push_back(extension);
    }
};

GltfBuilder::GltfBuilder() : impl_(std::make_unique<Impl>()) {
    tinygltf::Model& model = impl_->model;
    model.asset.version = "2.0";
    model.asset.generator = "mirrorstreet";
    model.buffers.emplace_back();
    model.scenes.emplace_back();
    model.defaultScene = 0;
    tinygltf::Sampler sampler;
    sampler.minFilter = TINYGLTF_TEXTURE_FILTER_LINEAR_MIPMAP_LINEAR;
    sampler.magFilter = TINYGLTF_TEXTURE_FILTER_LINEAR;
    sampler.wrapS = TINYGLTF_TEXTURE_WRAP_REPEAT;
    sampler.wrapT = TINYGLTF_TEXTURE_WRAP_REPEAT;
    model.samplers.push_back(sampler);
}

GltfBuilder::~GltfBuilder() = default;

int GltfBuilder::addTexture(const std::string& name, int size, std::span<const std::uint8_t> rgba) {
    const std::vector<unsigned char> png = encodePng(name, size, rgba);
    tinygltf::Model& model = impl_->model;
    tinygltf::Image image;
    image.name = name;
    image.mimeType = "image/png";
    image.bufferView = impl_->view(std::span<const unsigned char>(png), 0);
    model.images.push_back(image);
    tinygltf::Texture texture;
    texture.name = name;
    texture.sampler = 0;
    texture.source = static_cast<int>(model.images.size()) - 1;
    model.textures.push_back(texture);
    return static_cast<int>(model.textures.size()) - 1;
}

int GltfBuilder::addMaterial(const GltfMaterial& material) {
    tinygltf::Material m;
    m.name = material.name;
    m.pbrMetallicRoughness.baseColorFactor = {material.baseColour.x, material.baseColour.y,
                                              material.baseColour.z, 1};
    m.pbrMetallicRoughness.baseColorTexture.index = material.texture;
    m.pbrMetallicRoughness.metallicFactor = material.metallic;
    m.pbrMetallicRoughness.roughnessFactor = material.roughness;
    m.doubleSided = material.twoSided;
    if (material.cutout) {
        m.alphaMode = "MASK";
        m.alphaCutoff = 0.5;
    }
    if (material.clearCoat > 0) {
        impl_->use("KHR_materials_clearcoat");
        m.extensions["KHR_materials_clearcoat"] = numberObject("clearcoatFactor", material.clearCoat);
    }
    const float strongest = std::max({material.emission.x, material.emission.y, material.emission.z});
    // glTF's factors end at 1; what is brighter is a strength of its own.
    const glm::vec3 emission = strongest > 1 ? material.emission / strongest : material.emission;
    m.emissiveFactor = {emission.x, emission.y, emission.z};
    if (strongest > 1) {
        impl_->use("KHR_materials_emissive_strength");
        m.extensions["KHR_materials_emissive_strength"] = numberObject("emissiveStrength", strongest);
    }
    impl_->model.materials.push_back(m);
    return static_cast<int>(impl_->model.materials.size()) - 1;
}

int GltfBuilder::addMesh(const std::string& name, const city::Mesh& mesh, AxisTurn turn,
                         const std::function<int(std::uint32_t)>& materialOf) {
    std::map<int, Part> parts;
    std::vector<std::uint32_t> renumbered(mesh.vertices.size(), unused);
    for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
        // All corners of a triangle share their material; the first one speaks.
        Part& part = parts[materialOf(mesh.vertices[mesh.indices[t]].material)];
        for (std::size_t c = 0; c < 3; ++c) {
            const std::uint32_t corner = mesh.indices[t + c];
            if (renumbered[corner] == unused) {
                renumbered[corner] = static_cast<std::uint32_t>(part.positions.size() / 3);
                const city::Vertex& v = mesh.vertices[corner];
                const glm::vec3 p = turn(v.position);
                const glm::vec3 n = turn(v.normal);
                part.positions.insert(part.positions.end(), {p.x, p.y, p.z});
                part.normals.insert(part.normals.end(), {n.x, n.y, n.z});
                part.texcoords.insert(part.texcoords.end(), {v.texcoord.x, v.texcoord.y});
                for (int k = 0; k < 3; ++k) {
                    const auto i = static_cast<std::size_t>(k);
                    part.low[i] = std::min(part.low[i], static_cast<double>(p[k]));
                    part.high[i] = std::max(part.high[i], static_cast<double>(p[k]));
                }
            }
            part.indices.push_back(renumbered[corner]);
        }
    }
    if (parts.empty()) return -1;
    tinygltf::Mesh out;
    out.name = name;
    for (const auto& [material, part] : parts) {
        tinygltf::Primitive primitive;
        primitive.mode = TINYGLTF_MODE_TRIANGLES;
        primitive.material = material;
        primitive.attributes["POSITION"] = impl_->floats(part.positions, TINYGLTF_TYPE_VEC3, 3);
        impl_->model.accessors.back().minValues = part.low;
        impl_->model.accessors.back().maxValues = part.high;
        primitive.attributes["NORMAL"] = impl_->floats(part.normals, TINYGLTF_TYPE_VEC3, 3);
        primitive.attributes["TEXCOORD_0"] = impl_->floats(part.texcoords, TINYGLTF_TYPE_VEC2, 2);
        primitive.indices = impl_->accessor(
            impl_->view(std::span<const std::uint32_t>(part.indices), TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER),
            TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, TINYGLTF_TYPE_SCALAR, part.indices.size());
        out.primitives.push_back(primitive);
        impl_->triangles += part.indices.size() / 3;
    }
    impl_->model.meshes.push_back(out);
    return static_cast<int>(impl_->model.meshes.size()) - 1;
}

int GltfBuilder::addNode(const std::string& name, int mesh, const glm::mat4& transform, int parent) {
    tinygltf::Model& model = impl_->model;
    tinygltf::Node node;
    node.name = name;
    node.mesh = mesh;
    if (transform != glm::mat4(1))
        for (int c = 0; c < 4; ++c)
            for (int r = 0; r < 4; ++r) node.matrix.push_back(transform[c][r]);
    model.nodes.push_back(node);
    const int index = static_cast<int>(model.nodes.size()) - 1;
    if (parent >= 0)
        model.nodes[static_cast<std::size_t>(parent)].children.push_back(index);
    else
        model.scenes[0].nodes.push_back(index);
    return index;
}

void GltfBuilder::write(const std::filesystem::path& file) const {
    if (impl_->triangles == 0)
        throw std::runtime_error("there is nothing to export to '" + file.string() +
                                 "'; choose another city or vehicle.");
    AsideFile aside(file);
    tinygltf::TinyGLTF writer;
    const bool written =
        writer.WriteGltfSceneToFile(&impl_->model, aside.aside().string(), true, true, false, true);
    // The writer does not notice a full disk; a binary glTF file tells its own length.
    std::array<std::uint32_t, 3> header{};
    std::ifstream(aside.aside(), std::ios::binary)
        .read(reinterpret_cast<char*>(header.data()), sizeof header);
    std::error_code error;
    if (!written || header[2] == 0 || std::filesystem::file_size(aside.aside(), error) != header[2] || error)
        throw std::runtime_error("cannot write '" + file.string() + "'; make room or choose another place.");
    aside.commit();
}

glm::mat4 gltfFromWorldTransform(const glm::mat4& transform) {
    const glm::mat4 turn(1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1);
    const glm::mat4 back(1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1);
    return turn * transform * back;
}

}  // namespace app
