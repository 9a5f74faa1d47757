#include "app/render/VehiclePass.h"

#include <algorithm>
#include <glm/common.hpp>
#include <glm/mat3x3.hpp>
#include <tuple>
#include <utility>

#include "app/frame/VehicleLevels.h"
#include "app/frame/VehicleShading.h"

namespace app {

namespace {

VehicleInstance instanceOf(const glm::mat3& r, const glm::vec3& t, const vehicles::VehiclePose& pose,
                           const glm::vec4& map) {
    return {glm::vec4(r[0].x, r[1].x, r[2].x, t.x), glm::vec4(r[0].y, r[1].y, r[2].y, t.y),
            glm::vec4(r[0].z, r[1].z, r[2].z, t.z), glm::vec4(pose.paint, pose.braking ? 1.f : 0.f), map};
}

}  // namespace

VehiclePass::VehiclePass(std::span<const vehicles::VehicleModel> models) : geometry_(models) {
    // One level at a time: the level is chosen per pixel, and half the fetches are what reflections cost most
    // in software.
    mapSampler_ = reflection::gl::Sampler::create(GL_LINEAR_MIPMAP_NEAREST, GL_LINEAR, GL_CLAMP_TO_EDGE);
    for (std::size_t target = 0; target < 2; ++target)
        for (const Mirror mirror : {Mirror::plain, Mirror::map, Mirror::parallax, Mirror::screen})
            programs_[target][static_cast<std::size_t>(mirror)] =
                programFor(static_cast<PassTarget>(target), mirror, false);
}

reflection::gl::Program VehiclePass::programFor(PassTarget target, Mirror mirror, bool chrome) {
    std::vector<std::string> defines = definesFor(target);
    if (mirror == Mirror::map || mirror == Mirror::parallax) defines.emplace_back("REFLECTIVE");
    if (mirror == Mirror::parallax) defines.emplace_back("PARALLAX");
    if (mirror == Mirror::screen) defines.emplace_back("SCREEN");
    if (chrome) defines.emplace_back("CHROME");
    return reflection::gl::Program::fromFiles({"vehicle.vert", "vehicle.frag"}, defines);
}

glm::vec3 VehiclePass::centreOf(const vehicles::VehiclePose& pose, const glm::dvec3& eye) const {
    const glm::vec3 position(pose.position - eye);
    if (pose.model >= geometry_.models().size()) return position;
    return position + worldFromVehicle(pose) * geometry_.models()[pose.model].centre;
}

city::Aabb VehiclePass::boundsOf(const vehicles::VehiclePose& pose) const {
    city::Aabb box;
    if (pose.model >= geometry_.models().size()) return box;
    const VehicleGeometry::Model& model = geometry_.models()[pose.model];
    const glm::mat3 rotation = worldFromVehicle(pose);
    const glm::mat3 extent(glm::abs(rotation[0]), glm::abs(rotation[1]), glm::abs(rotation[2]));
    const glm::vec3 centre = glm::vec3(pose.position) + rotation * model.centre;
    const glm::vec3 half = extent * model.halfSize;
    box.extend(centre - half);
    box.extend(centre + half);
    return box;
}

VehiclePass::Counts VehiclePass::draw(const PassView& view, PassTarget target,
                                      std::span<const vehicles::VehiclePose> poses,
                                      std::span<const std::uint32_t> chosen, const Reflections& reflections,
                                      float tolerance) {
    Counts counts;
    pieces_.clear();
    const auto parallax = [&](std::size_t sizeClass) {
        return reflections.textures != nullptr && reflections.textures->nearnessArrays[sizeClass] != 0;
    };
    for (std::uint32_t index : chosen) {
        const vehicles::VehiclePose& pose = poses[index];
        if (pose.model >= geometry_.models().size()) continue;
        const VehicleGeometry::Model& model = geometry_.models()[pose.model];
        if (model.levels.empty()) continue;
        const glm::mat3 rotation = worldFromVehicle(pose);
        const glm::vec3 position(pose.position - view.eye);
        const glm::vec3 centre = position + rotation * model.centre;
        const float distance = std::max(glm::length(centre) - model.radius, 0.1f);
        const float allowed = view.allowedError(tolerance, distance);
        std::size_t level = 0;
        while (level + 1 < model.levels.size() && model.levels[level + 1].error <= allowed) ++level;

        reflection::LocalMapSlot slot;
        if (reflections.textures != nullptr && index < reflections.slots.size())
            slot = reflections.slots[index];
        const auto sizeClass = static_cast<std::size_t>(std::max<int>(slot.sizeClass, 0));
        const bool reflective = slot.valid() && reflections.mirrored == 0 &&
                                sizeClass < reflections.textures->cubeArrays.size() &&
                                reflections.textures->cubeArrays[sizeClass] != 0;
        const std::int32_t group = reflective ? static_cast<std::int32_t>(sizeClass) : -1;
        const bool chrome = reflections.closeLight != 0 && target == PassTarget::view &&
                            std::ranges::binary_search(reflections.withChrome, index);
        glm::vec4 map(0, 0, 0, slot.layer);
        if (reflective && parallax(sizeClass))
            map = glm::vec4(
                glm::vec3(reflections.textures->centres[sizeClass][static_cast<std::size_t>(slot.layer)] -
                          view.eye),
                map.w);
        const auto add = [&](const MeshRange& range, const VehicleInstance& instance) {
            if (!range.empty()) pieces_.push_back({group, chrome, range.firstIndex, range, instance});
        };
        add(model.levels[level].body, instanceOf(rotation, position, pose, map));
        if (!model.levels[level].wheelsInBody && !model.wheelLevels.empty()) {
            std::size_t wheelLevel = 0;
            while (wheelLevel + 1 < model.wheelLevels.size() &&
                   model.wheelLevels[wheelLevel + 1].error <= allowed)
                ++wheelLevel;
            const MeshRange& wheelMesh = model.wheelLevels[wheelLevel].mesh;
            for (const vehicles::VehicleModel::Wheel& wheel : model.wheels) {
                add(wheelMesh, instanceOf(rotation * vehicleFromWheel(wheel, pose),
                                          position + rotation * wheel.centre, pose, map));
            }
        }
        ++counts.vehicles;
    }
    if (pieces_.empty()) return counts;

    order_.resize(pieces_.size());
    for (std::uint32_t i = 0; i < order_.size(); ++i) order_[i] = i;
    const auto key = [&](std::uint32_t i) {
        return std::tuple(pieces_[i].sizeClass, pieces_[i].chrome, pieces_[i].firstIndex);
    };
    std::ranges::stable_sort(order_, [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
    instances_.clear();
    for (std::uint32_t i : order_) instances_.push_back(pieces_[i].instance);
    geometry_.instances().replace(std::span<const VehicleInstance>(instances_));

    geometry_.array().bind();
    mapSampler_.bind(2);
    glEnable(GL_CULL_FACE);
    std::pair<int, bool> used{-2, false};
    for (std::size_t first = 0; first < order_.size();) {
        std::size_t last = first;
        while (last < order_.size() && key(order_[last]) == key(order_[first])) ++last;
        const Piece& piece = pieces_[order_[first]];
        if (const std::pair wanted(piece.sizeClass, piece.chrome); wanted != used) {
            used = wanted;
            const auto sizeClass = static_cast<std::size_t>(std::max(piece.sizeClass, 0));
            const Mirror mirror = piece.sizeClass >= 0
                                      ? (parallax(sizeClass) ? Mirror::parallax : Mirror::map)
                                  : reflections.mirrored != 0 ? Mirror::screen
                                                              : Mirror::plain;
            const auto which = static_cast<std::size_t>(mirror);
            if (piece.chrome && !chromePrograms_[which])
                chromePrograms_[which] = programFor(PassTarget::view, mirror, true);
            (piece.chrome ? chromePrograms_[which] : programs_[static_cast<std::size_t>(target)][which])
                .use();
            if (mirror == Mirror::screen) glBindTextureUnit(3, reflections.mirrored);
            if (piece.sizeClass >= 0) glBindTextureUnit(2, reflections.textures->cubeArrays[sizeClass]);
            if (mirror == Mirror::parallax) {
                glBindTextureUnit(4, reflections.textures->nearnessArrays[sizeClass]);
            }
            if (piece.chrome) {
                glBindTextureUnit(5, reflections.closeLight);
                glBindTextureUnit(6, reflections.closeDepth);
            }
        }
        glDrawElementsInstancedBaseVertexBaseInstance(
            GL_TRIANGLES, static_cast<GLsizei>(piece.range.indexCount), GL_UNSIGNED_INT,
            reinterpret_cast<const void*>(static_cast<std::uintptr_t>(piece.range.firstIndex) *
                                          sizeof(std::uint32_t)),
            static_cast<GLsizei>(last - first), piece.range.baseVertex, static_cast<GLuint>(first));
        ++counts.drawCalls;
        counts.triangles += std::uint64_t{piece.range.indexCount / 3} * (last - first);
        first = last;
    }
    glBindSampler(2, 0);
    return counts;
}

}  // namespace app
