#include "vehicles/import/ReadGltf.h"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wpedantic"
#include <stb/stb_image.h>
#include <tiny_gltf.h>
#pragma GCC diagnostic pop

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstring>
#include <fstream>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <limits>
#include <stdexcept>

namespace vehicles {
namespace {

std::string lower(std::string s) {
    for (char& c : s) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return s;
}

/// Says what is wrong with which file.
class Complaint {
  public:
    explicit Complaint(const std::filesystem::path& file) : file_(file.string()) {}
    [[noreturn]] void raise(const std::string& what) const { throw std::runtime_error(file_ + ": " + what); }

  private:
    std::string file_;
};

std::vector<unsigned char> readFile(const std::filesystem::path& file, const Complaint& complaint) {
    std::error_code failed;
    const auto size = std::filesystem::file_size(file, failed);
    if (failed || std::filesystem::is_directory(file))
        complaint.raise("the file cannot be read; check that it exists and is readable");
    std::vector<unsigned char> bytes(size);
    std::ifstream stream(file, std::ios::binary);
    stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
    if (!stream) complaint.raise("the file cannot be read; check that it exists and is readable");
    return bytes;
}

void checkHeader(const std::vector<unsigned char>& bytes, const Complaint& complaint) {
    std::array<std::uint32_t, 5> header{};
    if (bytes.size() >= 4 && std::memcmp(bytes.data(), "glTF", 4) != 0)
        complaint.raise(
            "at byte 0: this is not a binary glTF file (no 'glTF' mark); export the vehicle as .glb");
    if (bytes.size() < sizeof(header))
        complaint.raise("the file ends after " + std::to_string(bytes.size()) +
                        " bytes, inside the header; copy it again");
    std::memcpy(header.data(), bytes.data(), sizeof(header));
    if (header[1] != 2)
        complaint.raise("at byte 4: glTF version " + std::to_string(header[1]) +
                        " is not supported; export as glTF 2.0");
    if (header[2] > bytes.size())
        complaint.raise("the file is cut off: its header promises " + std::to_string(header[2]) +
                        " bytes, there are " + std::to_string(bytes.size()) + "; copy it again");
}

/// tinygltf's own loader of pictures would also take film and shop formats that glTF does not have, and make
/// room for as many pixels as they name: deflate shrinks by 1032 at most (zlib's documentation), and a JPEG
/// picture spends a bit or more on 64 pixels. `bytes` are at least `size`.
bool loadPicture(tinygltf::Image& image, int index, std::string& error, const unsigned char* bytes,
                 int size) {
    constexpr std::array<unsigned char, 4> png{0x89, 'P', 'N', 'G'};
    constexpr std::array<unsigned char, 3> jpeg{0xff, 0xd8, 0xff};
    const auto begins = [&](const auto& mark) {
        return size >= static_cast<int>(mark.size()) && std::equal(mark.begin(), mark.end(), bytes);
    };
    const std::string place = "image " + std::to_string(index);
    int across = 0, down = 0, channels = 0;
    if ((!begins(png) && !begins(jpeg)) ||
        stbi_info_from_memory(bytes, size, &across, &down, &channels) != 1) {
        error += place + " is neither a PNG nor a JPEG picture";
        return false;
    }
    if (across < 1 || down < 1 || std::int64_t{across} * down > std::int64_t{1032} * size) {
        error += place + " names " + std::to_string(across) + " x " + std::to_string(down) +
                 " pixels, more than it can hold";
        return false;
    }
    std::string warning;
    return tinygltf::LoadImageData(&image, index, &error, &warning, 0, 0, bytes, size, nullptr);
}

/// For tinygltf. It does not look whether a view lies within its buffer: see loadPictures.
bool loadOtherFilesPicture(tinygltf::Image* image, int index, std::string* error, std::string*, int, int,
                           const unsigned char* bytes, int size, void*) {
    return image->bufferView >= 0 || loadPicture(*image, index, *error, bytes, size);
}

/// Those within the file itself.
bool loadPictures(tinygltf::Model& model, std::string& error) {
    for (std::size_t i = 0; i < model.images.size(); ++i) {
        tinygltf::Image& image = model.images[i];
        if (image.bufferView < 0) continue;
        // That they exist, tinygltf has checked.
        const tinygltf::BufferView& view = model.bufferViews[static_cast<std::size_t>(image.bufferView)];
        const auto& data = model.buffers[static_cast<std::size_t>(view.buffer)].data;
        if (view.byteOffset > data.size() || view.byteLength > data.size() - view.byteOffset ||
            view.byteLength > std::numeric_limits<int>::max()) {
            error += "image " + std::to_string(i) + " reaches past its buffer";
            return false;
        }
        if (!loadPicture(image, static_cast<int>(i), error, data.data() + view.byteOffset,
                         static_cast<int>(view.byteLength)))
            return false;
    }
    return true;
}

class Reader {
  public:
    Reader(const tinygltf::Model& model, const Complaint& complaint) : model_(model), complaint_(complaint) {}

    GltfScene read() {
        for (const tinygltf::Material& m : model_.materials) {
            GltfMaterial out;
            out.name = lower(m.name);
            const auto& pbr = m.pbrMetallicRoughness;
            for (int k = 0; k < 4 && k < static_cast<int>(pbr.baseColorFactor.size()); ++k)
                out.colour[k] = static_cast<float>(pbr.baseColorFactor[static_cast<std::size_t>(k)]);
            out.metallic = static_cast<float>(pbr.metallicFactor);
            out.roughness = static_cast<float>(pbr.roughnessFactor);
            out.blended = m.alphaMode == "BLEND";
            out.textured = pbr.baseColorTexture.index >= 0;
            scene_.materials.push_back(out);
        }
        std::vector<int> roots;
        if (!model_.scenes.empty()) {
            const int wanted = model_.defaultScene >= 0 ? model_.defaultScene : 0;
            if (wanted >= static_cast<int>(model_.scenes.size()))
                complaint_.raise("scene " + std::to_string(wanted) + " does not exist; export it again");
            roots = model_.scenes[static_cast<std::size_t>(wanted)].nodes;
        } else {
            for (int i = 0; i < static_cast<int>(model_.nodes.size()); ++i) roots.push_back(i);
        }
        for (const int root : roots) visit(root, glm::mat4(1), "", -1, 0);
        if (scene_.triangles.empty())
            complaint_.raise("there are no triangles in its scene; export the vehicle as a triangle mesh");
        return std::move(scene_);
    }

  private:
    static glm::mat4 transformOf(const tinygltf::Node& node) {
        if (node.matrix.size() == 16) return glm::mat4(glm::make_mat4(node.matrix.data()));
        glm::mat4 m(1);
        const auto f = [](double v) { return static_cast<float>(v); };
        if (node.translation.size() == 3)
            m[3] = {f(node.translation[0]), f(node.translation[1]), f(node.translation[2]), 1};
        if (node.rotation.size() == 4)
            m = m * glm::mat4_cast(glm::quat(f(node.rotation[3]), f(node.rotation[0]), f(node.rotation[1]),
                                             f(node.rotation[2])));
        if (node.scale.size() == 3)
            for (int k = 0; k < 3; ++k) m[k] *= f(node.scale[static_cast<std::size_t>(k)]);
        return m;
    }

    void visit(int index, const glm::mat4& parent, const std::string& path, int wheel, int depth) {
        const std::string place = "node " + std::to_string(index);
        if (index < 0 || index >= static_cast<int>(model_.nodes.size()))
            complaint_.raise(place + " does not exist; export it again");
        // A tree cannot be deeper than this in a sane file, and a cycle would never end; a shared node may
        // repeat, but not so that each level has twice the nodes of that above it.
        if (depth > 64 || ++visited_ > 16 * model_.nodes.size())
            complaint_.raise(place + ": the nodes form a cycle or nest too deeply; export it again");
        const tinygltf::Node& node = model_.nodes[static_cast<std::size_t>(index)];
        const glm::mat4 world = parent * transformOf(node);
        std::string name = path + "/" + lower(node.name);
        const bool hasMesh = node.mesh >= 0;
        if (hasMesh) {
            if (node.mesh >= static_cast<int>(model_.meshes.size()))
                complaint_.raise(place + " names a mesh that does not exist; export it again");
            name += "/" + lower(model_.meshes[static_cast<std::size_t>(node.mesh)].name);
        }
        if (wheel < 0 && name.find("wheel") != std::string::npos &&
            name.find("steering") == std::string::npos)
            wheel = index;
        if (hasMesh) {
            const int part = static_cast<int>(scene_.parts.size());
            scene_.parts.push_back({name, wheel});
            const auto& primitives = model_.meshes[static_cast<std::size_t>(node.mesh)].primitives;
            for (std::size_t p = 0; p < primitives.size(); ++p)
                addPrimitive(primitives[p], world, part,
                             "mesh " + std::to_string(node.mesh) + ", primitive " + std::to_string(p));
        }
        for (const int child : node.children) visit(child, world, name, wheel, depth + 1);
    }

    /// An accessor's values as floats, `components` a row.
    std::vector<float> values(int index, int components, const std::string& place, bool indices = false) {
        const auto broken = [&](const std::string& why) {
            complaint_.raise(place + ", accessor " + std::to_string(index) + ": " + why +
                             "; export it again");
        };
        if (index < 0 || index >= static_cast<int>(model_.accessors.size())) broken("does not exist");
        const tinygltf::Accessor& a = model_.accessors[static_cast<std::size_t>(index)];
        if (a.sparse.isSparse) broken("sparse accessors are not supported");
        if (a.bufferView < 0 || a.bufferView >= static_cast<int>(model_.bufferViews.size()))
            broken("has no data");
        const tinygltf::BufferView& view = model_.bufferViews[static_cast<std::size_t>(a.bufferView)];
        if (view.buffer < 0 || view.buffer >= static_cast<int>(model_.buffers.size()))
            broken("has no buffer");
        const std::vector<unsigned char>& data = model_.buffers[static_cast<std::size_t>(view.buffer)].data;
        const int held = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(a.type));
        const int size = tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(a.componentType));
        if (held < components || size <= 0) broken("has the wrong type");
        const std::size_t element = static_cast<std::size_t>(held) * static_cast<std::size_t>(size);
        const std::size_t stride = view.byteStride ? view.byteStride : element;
        const std::size_t start = view.byteOffset + a.byteOffset;
        if (stride > 4096 || view.byteOffset > data.size() || a.byteOffset > data.size() ||
            a.count > data.size())
            broken("reaches past its buffer");
        if (a.count && (start > data.size() || start + (a.count - 1) * stride + element > data.size()))
            broken("reaches past its buffer");
        std::vector<float> out;
        out.reserve(a.count * static_cast<std::size_t>(components));
        for (std::size_t i = 0; i < a.count; ++i)
            for (int c = 0; c < components; ++c) {
                const unsigned char* at =
                    data.data() + start + i * stride + static_cast<std::size_t>(c * size);
                const auto as = [&](auto zero) {
                    std::memcpy(&zero, at, sizeof(zero));
                    return zero;
                };
                float v = 0;
                float full = 1;
                switch (a.componentType) {
                    case TINYGLTF_COMPONENT_TYPE_FLOAT:
                        v = as(0.0f);
                        break;
                    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
                        v = as(std::uint8_t{});
                        full = 255;
                        break;
                    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
                        v = as(std::uint16_t{});
                        full = 65535;
                        break;
                    case TINYGLTF_COMPONENT_TYPE_BYTE:
                        v = as(std::int8_t{});
                        full = 127;
                        break;
                    case TINYGLTF_COMPONENT_TYPE_SHORT:
                        v = as(std::int16_t{});
                        full = 32767;
                        break;
                    // Exact up to 2^24, more vertices than any vehicle here may have.
                    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
                        v = static_cast<float>(as(std::uint32_t{}));
                        break;
                    default:
                        broken("has an unknown component type");
                }
                out.push_back(a.normalized && !indices ? std::max(v / full, -1.0f) : v);
            }
        return out;
    }

    glm::vec4 texel(const tinygltf::Material& material, const glm::vec2& uv) {
        const int texture = material.pbrMetallicRoughness.baseColorTexture.index;
        if (texture < 0 || texture >= static_cast<int>(model_.textures.size())) return glm::vec4(1);
        const int source = model_.textures[static_cast<std::size_t>(texture)].source;
        if (source < 0 || source >= static_cast<int>(model_.images.size())) return glm::vec4(1);
        const tinygltf::Image& image = model_.images[static_cast<std::size_t>(source)];
        const auto channels = static_cast<std::size_t>(std::max(image.component, 0));
        if (image.width <= 0 || image.height <= 0 || image.bits != 8 || channels < 3 ||
            image.image.size() <
                static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) * channels)
            return glm::vec4(1);
        const auto wrap = [](float t, int n) {
            if (!std::isfinite(t)) return 0;
            return std::clamp(static_cast<int>((t - std::floor(t)) * static_cast<float>(n)), 0, n - 1);
        };
        const auto x = static_cast<std::size_t>(wrap(uv.x, image.width)),
                   y = static_cast<std::size_t>(wrap(uv.y, image.height));
        const unsigned char* at =
            image.image.data() + (y * static_cast<std::size_t>(image.width) + x) * channels;
        const auto linear = [&](int k) { return std::pow(static_cast<float>(at[k]) / 255.0f, 2.2f); };
        return {linear(0), linear(1), linear(2), channels > 3 ? static_cast<float>(at[3]) / 255.0f : 1.0f};
    }

    void addPrimitive(const tinygltf::Primitive& primitive, const glm::mat4& world, int part,
                      const std::string& place) {
        const int mode = primitive.mode < 0 ? TINYGLTF_MODE_TRIANGLES : primitive.mode;
        if (mode != TINYGLTF_MODE_TRIANGLES && mode != TINYGLTF_MODE_TRIANGLE_STRIP &&
            mode != TINYGLTF_MODE_TRIANGLE_FAN)
            return;
        const auto attribute = [&](const char* name) {
            const auto found = primitive.attributes.find(name);
            return found == primitive.attributes.end() ? -1 : found->second;
        };
        const int positionAt = attribute("POSITION");
        if (positionAt < 0) complaint_.raise(place + ": it has no positions; export it again");
        const std::vector<float> position = values(positionAt, 3, place);
        const std::size_t count = position.size() / 3;
        if (count > (std::size_t{1} << 24))
            complaint_.raise(place + ": it has more than 16 million vertices; reduce the mesh first");
        std::vector<float> normal, uv;
        if (attribute("NORMAL") >= 0) normal = values(attribute("NORMAL"), 3, place);
        const bool known =
            primitive.material >= 0 && primitive.material < static_cast<int>(model_.materials.size());
        const tinygltf::Material* material =
            known ? &model_.materials[static_cast<std::size_t>(primitive.material)] : nullptr;
        if (material && material->pbrMetallicRoughness.baseColorTexture.index >= 0) {
            const std::string name =
                "TEXCOORD_" + std::to_string(material->pbrMetallicRoughness.baseColorTexture.texCoord);
            if (attribute(name.c_str()) >= 0) uv = values(attribute(name.c_str()), 2, place);
        }
        std::vector<float> colour;
        if (attribute("COLOR_0") >= 0) colour = values(attribute("COLOR_0"), 3, place);
        if ((!normal.empty() && normal.size() != position.size()) ||
            (!uv.empty() && uv.size() / 2 != count) || (!colour.empty() && colour.size() / 3 != count))
            complaint_.raise(place + ": its attributes differ in length; export it again");
        for (const float v : position)
            if (!std::isfinite(v))
                complaint_.raise(place +
                                 ": a position is not a finite number; clean the mesh and export it again");
        std::vector<std::size_t> corner;
        if (primitive.indices >= 0)
            for (const float i : values(primitive.indices, 1, place, true)) {
                // Before it becomes an integer: an accessor may hold anything, also negative numbers and NaN.
                if (!(i >= 0 && i < static_cast<float>(count)))
                    complaint_.raise(place + ": an index points past the last vertex; export it again");
                corner.push_back(static_cast<std::size_t>(i));
            }
        else
            for (std::size_t i = 0; i < count; ++i) corner.push_back(i);
        // Also triangles without a surface take their time.
        corners_ += count + corner.size();
        if (corners_ > 4 * std::size_t{20'000'000})
            complaint_.raise("it has more than 20 million triangles; reduce the mesh first");
        const auto add = [&](std::size_t a, std::size_t b, std::size_t c) {
            if (scene_.triangles.size() >= 20'000'000)
                complaint_.raise("it has more than 20 million triangles; reduce the mesh first");
            addTriangle({corner[a], corner[b], corner[c]}, position, normal, uv, colour, material, world,
                        part, primitive.material);
        };
        if (mode == TINYGLTF_MODE_TRIANGLES)
            for (std::size_t i = 0; i + 2 < corner.size(); i += 3) add(i, i + 1, i + 2);
        else
            for (std::size_t i = 0; i + 2 < corner.size(); ++i) {
                if (mode == TINYGLTF_MODE_TRIANGLE_FAN)
                    add(0, i + 1, i + 2);
                else if (i % 2 == 0)
                    add(i, i + 1, i + 2);
                else
                    add(i + 1, i, i + 2);
            }
    }

    void addTriangle(std::array<std::size_t, 3> corner, const std::vector<float>& position,
                     const std::vector<float>& normal, const std::vector<float>& uv,
                     const std::vector<float>& colour, const tinygltf::Material* material,
                     const glm::mat4& world, int part, int materialIndex) {
        const glm::mat3 linear(world);
        // A mirroring node turns triangles inside out.
        const float orientation = glm::determinant(linear);
        if (orientation < 0) std::swap(corner[1], corner[2]);
        GltfTriangle out;
        out.part = part;
        out.material = material ? materialIndex : -1;
        if (material) out.colour = scene_.materials[static_cast<std::size_t>(materialIndex)].colour;
        glm::vec2 middle{0};
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t i = corner[k];
            out.position[k] =
                glm::vec3(world * glm::vec4(position[3 * i], position[3 * i + 1], position[3 * i + 2], 1));
            if (!uv.empty()) middle += glm::vec2(uv[2 * i], uv[2 * i + 1]) / 3.0f;
            if (!colour.empty()) {
                const glm::vec3 tint{colour[3 * i], colour[3 * i + 1], colour[3 * i + 2]};
                out.colour *= glm::vec4(glm::pow(glm::max(tint, glm::vec3(0)), glm::vec3(1.0f / 3.0f)), 1);
            }
        }
        const glm::vec3 flat =
            glm::cross(out.position[1] - out.position[0], out.position[2] - out.position[0]);
        const float area = glm::length(flat);
        if (!(area > 0) || !std::isfinite(area)) return;  // no surface
        // Normals go with the inverse transpose, here as cofactors, which also exist for flattening nodes.
        const glm::mat3 cofactor(glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]),
                                 glm::cross(linear[0], linear[1]));
        for (std::size_t k = 0; k < 3; ++k) {
            out.normal[k] = flat / area;
            if (normal.empty()) continue;
            const std::size_t i = corner[k];
            const glm::vec3 n = cofactor * glm::vec3(normal[3 * i], normal[3 * i + 1], normal[3 * i + 2]) *
                                (orientation < 0 ? -1.0f : 1.0f);
            const float length = glm::length(n);
            if (length > 0 && std::isfinite(length)) out.normal[k] = n / length;
        }
        if (material && !uv.empty()) out.colour *= texel(*material, middle);
        scene_.triangles.push_back(out);
    }

    const tinygltf::Model& model_;
    const Complaint& complaint_;
    GltfScene scene_;
    std::size_t visited_ = 0, corners_ = 0;
};

}  // namespace

GltfScene readGltf(const std::filesystem::path& file) {
    const Complaint complaint(file);
    const std::vector<unsigned char> bytes = readFile(file, complaint);
    checkHeader(bytes, complaint);
    tinygltf::Model model;
    tinygltf::TinyGLTF loader;
    loader.SetImageLoader(&loadOtherFilesPicture, nullptr);
    std::string error, warning;
    bool good = false;
    try {
        good = loader.LoadBinaryFromMemory(&model, &error, &warning, bytes.data(),
                                           static_cast<unsigned int>(bytes.size()),
                                           file.parent_path().string()) &&
               loadPictures(model, error);
    } catch (const std::exception& e) {
        error = e.what();
    }
    for (const std::string& extension : model.extensionsUsed)
        if (extension == "KHR_draco_mesh_compression" || extension == "EXT_meshopt_compression")
            complaint.raise("it is compressed with " + extension +
                            ", which is not supported; export it without mesh compression");
    if (!good) {
        for (char& c : error)
            if (c == '\n' || c == '\r') c = ' ';
        while (!error.empty() && (error.back() == ' ' || error.back() == '.')) error.pop_back();
        complaint.raise("it cannot be parsed (" + (error.empty() ? std::string("no reason given") : error) +
                        "); check that the files it names lie beside it, or export it again as one .glb");
    }
    return Reader(model, complaint).read();
}

}  // namespace vehicles
