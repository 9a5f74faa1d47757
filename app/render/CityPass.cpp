#include "app/render/CityPass.h"

#include <algorithm>
#include <glm/common.hpp>

#include "app/frame/WetGround.h"

namespace app {

namespace {

constexpr std::uint32_t levelsPerPrototype = 64;

}  // namespace

CityPass::CityPass(const city::CityModel& city) : geometry_(city), materials_(city.materials) {
    for (std::size_t target = 0; target < passTargetCount; ++target) {
        for (std::size_t instanced = 0; instanced < 2; ++instanced) {
            for (std::size_t cutout = 0; cutout < 2; ++cutout) {
                std::vector<std::string> defines = definesFor(static_cast<PassTarget>(target));
                if (instanced != 0) defines.emplace_back("INSTANCED");
                if (cutout != 0) defines.emplace_back("CUTOUT");
                const bool depth = static_cast<PassTarget>(target) == PassTarget::depth;
                programs_[target][instanced][cutout] = reflection::gl::Program::fromFiles(
                    {"city.vert", depth ? "depth.frag" : "city.frag"}, defines);
            }
        }
    }
}

void CityPass::Batch::clear() {
    counts.clear();
    offsets.clear();
    baseVertices.clear();
}

void CityPass::Batch::add(const MeshRange& range) {
    counts.push_back(static_cast<GLsizei>(range.indexCount));
    offsets.push_back(
        reinterpret_cast<const void*>(static_cast<std::uintptr_t>(range.firstIndex) * sizeof(std::uint32_t)));
    baseVertices.push_back(range.baseVertex);
}

void CityPass::useFor(Coverage coverage, bool instanced, PassTarget target) {
    if (coverage == Coverage::solid) {
        glEnable(GL_CULL_FACE);
    } else {
        glDisable(GL_CULL_FACE);
    }
    programs_[static_cast<std::size_t>(target)][instanced ? 1 : 0][coverage == Coverage::cutout ? 1 : 0]
        .use();
}

CityPass::Counts CityPass::draw(const PassView& view, PassTarget target, float tolerance) {
    Counts counts;
    materials_.bind();
    const glm::vec3 eye(view.eye);

    // Chunks, nearest first, so that what lies behind is rejected before it is shaded.
    order_.clear();
    const auto& chunks = geometry_.chunks();
    for (std::uint32_t i = 0; i < chunks.size(); ++i) {
        if (chunks[i].onlyShadow && target != PassTarget::depth) continue;
        const glm::vec3 centre = chunks[i].bounds.centre() - eye;
        const glm::vec3 half = 0.5f * chunks[i].bounds.size();
        if (!view.sees(chunks[i].bounds)) {
            ++counts.chunksCulled;
            continue;
        }
        const glm::vec3 nearest = glm::max(glm::abs(centre) - half, glm::vec3(0));
        // Ground goes last: buildings and cars hide much of it.
        const float late = chunks[i].kind == city::ChunkKind::ground ? 1e6f : 0.f;
        order_.emplace_back(glm::length(nearest) + late, i);
        ++counts.chunksDrawn;
    }
    std::ranges::sort(order_);
    for (Batch& batch : batches_) batch.clear();
    for (const auto& [distance, i] : order_)
        for (std::size_t c = 0; c < coverageCount; ++c)
            if (!chunks[i].ranges[c].empty()) {
                batches_[c].add(chunks[i].ranges[c]);
                counts.triangles += chunks[i].ranges[c].indexCount / 3;
            }
    geometry_.chunkArray().bind();
    for (std::size_t c = 0; c < coverageCount; ++c) {
        const Batch& batch = batches_[c];
        if (batch.counts.empty()) continue;
        useFor(static_cast<Coverage>(c), false, target);
        glMultiDrawElementsBaseVertex(GL_TRIANGLES, batch.counts.data(), GL_UNSIGNED_INT,
                                      batch.offsets.data(), static_cast<GLsizei>(batch.counts.size()),
                                      batch.baseVertices.data());
        ++counts.drawCalls;
    }

    // Placements by prototype and level of detail, one instanced draw each.
    placed_.clear();
    const auto& placements = geometry_.placements();
    for (std::uint32_t i = 0; i < placements.size(); ++i) {
        const CityGeometry::Placement& p = placements[i];
        const glm::vec3 centre = p.centre - eye;
        if (!view.sees(p.bounds)) continue;
        if (view.allowedError(1, glm::length(centre)) > 2 * p.radius) continue;  // smaller than a pixel
        const auto& levels = geometry_.prototypes()[p.prototype].levels;
        const float distance = std::max(glm::length(centre) - p.radius, 0.1f);
        const float allowed = view.allowedError(tolerance, distance) / std::max(p.scale, 1e-6f);
        std::uint32_t level = 0;
        while (level + 1 < levels.size() && level + 1 < levelsPerPrototype &&
               levels[level + 1].error <= allowed)
            ++level;
        placed_.push_back({p.prototype * levelsPerPrototype + level, distance, i});
    }
    if (placed_.empty()) return counts;
    std::ranges::sort(placed_, [](const Placed& a, const Placed& b) {
        return a.key != b.key ? a.key < b.key : a.distance < b.distance;
    });
    instances_.clear();
    for (const Placed& p : placed_) instances_.push_back(placements[p.placement].instance);
    geometry_.instances().replace(std::span<const PlacementInstance>(instances_));
    geometry_.instancedArray().bind();
    for (std::size_t c = 0; c < coverageCount; ++c) {
        bool used = false;
        for (std::size_t first = 0; first < placed_.size();) {
            std::size_t last = first;
            while (last < placed_.size() && placed_[last].key == placed_[first].key) ++last;
            const std::uint32_t key = placed_[first].key;
            const MeshRange& range =
                geometry_.prototypes()[key / levelsPerPrototype].levels[key % levelsPerPrototype].ranges[c];
            if (!range.empty()) {
                if (!used) useFor(static_cast<Coverage>(c), true, target);
                used = true;
                glDrawElementsInstancedBaseVertexBaseInstance(
                    GL_TRIANGLES, static_cast<GLsizei>(range.indexCount), GL_UNSIGNED_INT,
                    reinterpret_cast<const void*>(static_cast<std::uintptr_t>(range.firstIndex) *
                                                  sizeof(std::uint32_t)),
                    static_cast<GLsizei>(last - first), range.baseVertex, static_cast<GLuint>(first));
                ++counts.drawCalls;
                counts.triangles += std::uint64_t{range.indexCount / 3} * (last - first);
            }
            first = last;
        }
    }
    return counts;
}

CityPass::Counts CityPass::drawWet(const PassView& view, PassTarget target, const Wet* wet) {
    Counts counts;
    reflection::gl::Program& program = wetPrograms_[static_cast<std::size_t>(target)][wet != nullptr ? 1 : 0];
    if (!program) {
        std::vector<std::string> defines = wetDefinitions();
        defines.emplace_back("WET");
        if (target == PassTarget::cube) defines.emplace_back("CUBE");
        if (wet != nullptr) defines.emplace_back("MIRROR");
        program = reflection::gl::Program::fromFiles({"city.vert", "wet_ground.frag"}, defines);
    }
    if (wet != nullptr) {
        program.set("planeHeight", static_cast<float>(wet->height - view.eye.z));
        program.set("uvPerRadian", wet->uvPerRadian);
        program.set("uvPerNdc", wet->uvPerNdc);
        program.set("blurLevels", wet->map.blurred != 0 ? wet->map.blurLevels : 0);
        program.set("uvFromFragment", wet->map.uvFromFragment);
        program.set("uvLimits", wet->map.uvLimits);
        program.set("blurredScale", wet->map.blurredScale);
        glBindTextureUnit(8, wet->map.colour);
        glBindTextureUnit(9, wet->map.blurred != 0 ? wet->map.blurred : wet->map.colour);
    }
    materials_.bind();
    Batch& batch = batches_[static_cast<std::size_t>(Coverage::solid)];
    batch.clear();
    for (const CityGeometry::Chunk& chunk : geometry_.chunks()) {
        const MeshRange& range = chunk.ranges[static_cast<std::size_t>(Coverage::solid)];
        if (chunk.kind != city::ChunkKind::ground || range.empty() || !view.sees(chunk.bounds)) continue;
        batch.add(range);
        counts.triangles += range.indexCount / 3;
        ++counts.chunksDrawn;
    }
    if (batch.counts.empty()) return counts;
    geometry_.chunkArray().bind();
    program.use();
    glEnable(GL_CULL_FACE);
    // The same triangles again: a rounding must not let the dry ground show through.
    glEnable(GL_POLYGON_OFFSET_FILL);
    glPolygonOffset(0, 4);
    glMultiDrawElementsBaseVertex(GL_TRIANGLES, batch.counts.data(), GL_UNSIGNED_INT, batch.offsets.data(),
                                  static_cast<GLsizei>(batch.counts.size()), batch.baseVertices.data());
    glDisable(GL_POLYGON_OFFSET_FILL);
    counts.drawCalls = 1;
    return counts;
}

}  // namespace app
