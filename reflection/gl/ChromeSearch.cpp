#include "reflection/gl/ChromeSearch.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <limits>

namespace reflection {

namespace {

// Bindings and layouts of data/shaders/chrome_map.glsl and chrome_result.glsl.
constexpr GLuint blockBinding = 0;
constexpr GLuint cornersBinding = 0, coverageBinding = 1, normalsBinding = 2, verticesBinding = 3,
                 resultsBinding = 4, countsBinding = 5, leftBinding = 6;
constexpr std::size_t groupSize = 64;
/// As many groups every implementation can dispatch; shaders go round.
constexpr std::size_t mostGroups = 32768;

struct SearchBlock {
    glm::dvec4 axisX, axisY, axisZ, eye, eyeUnit, eyeFoot, eyeNormal, stretch;
    glm::vec2 radii;
    std::uint32_t cells = 0, vertexCount = 0, concave = 0, eyeInside = 0, normalSide = 0, hasCovered = 0;
};
static_assert(sizeof(SearchBlock) == 288);

/// DispatchIndirectCommand and the number of vertices.
struct LeftCount {
    std::uint32_t groups[3] = {0, 1, 1};
    std::uint32_t count = 0;
};
using LeftCounts = std::array<LeftCount, 2>;
static_assert(sizeof(LeftCounts) == 32);

template <class T>
GLintptr offsetOf(std::size_t k) {
    return static_cast<GLintptr>(k * sizeof(T));
}

SearchBlock blockFor(const ReflectorMap& map, const glm::dvec3& at, std::size_t count) {
    const MapFrame& frame = map.frame();
    const glm::dvec3 eye = frame.toMap(at);
    const ReflectorMap::Sample under = map.sample(eye);
    const double length = glm::length(eye);
    SearchBlock block{};
    block.axisX = {frame.axes[0], frame.scale};
    block.axisY = {frame.axes[1], 0};
    block.axisZ = {frame.axes[2], 0};
    block.eye = {eye, under.gauge};
    block.eyeUnit = {length > 0 ? eye / length : glm::dvec3(0), 0};
    block.eyeFoot = {under.position, 0};
    block.eyeNormal = {under.normal, 0};
    block.stretch = {frame.stretch, 0};
    block.radii = {map.innerRadius(), map.outerRadius()};
    block.cells = static_cast<std::uint32_t>(map.cellsPerSide());
    block.vertexCount = static_cast<std::uint32_t>(count);
    block.concave = map.bend() == Bend::concave ? 1 : 0;
    block.eyeInside = map.bend() == Bend::convex && !(under.gauge > 1) ? 1 : 0;
    block.normalSide = ReflectorMap::normalTableSide;
    block.hasCovered = map.coveredNormalTable().empty() ? 0 : 1;
    return block;
}

}  // namespace

ChromeMapBuffer::ChromeMapBuffer(const ReflectorMap& map) : map_(map) {
    // Four bytes a word.
    std::vector<std::uint32_t> coverage((map.coverage().size() + 3) / 4, 0);
    for (std::size_t i = 0; i < map.coverage().size(); ++i)
        coverage[i / 4] |= static_cast<std::uint32_t>(map.coverage()[i]) << (8 * (i % 4));
    std::vector<glm::vec4> normals;
    for (const glm::vec3& d : map.normalTable()) normals.emplace_back(d, 0.0f);
    for (const glm::vec3& d : map.coveredNormalTable()) normals.emplace_back(d, 0.0f);
    corners_ = gl::Buffer::filled(map.corners());
    coverage_ = gl::Buffer::filled(std::span<const std::uint32_t>(coverage));
    normals_ = gl::Buffer::filled(std::span<const glm::vec4>(normals));
    bytes_ = map.corners().size_bytes() + coverage.size() * sizeof(std::uint32_t) +
             normals.size() * sizeof(glm::vec4);
}

ChromeSearch::ChromeSearch()
    : fast_(gl::Program::fromFiles({"chrome_search.comp"})),
      precise_(gl::Program::fromFiles({"chrome_search.comp"}, {"REAL_IS_DOUBLE"})),
      thorough_(gl::Program::fromFiles({"chrome_search_thorough.comp"})),
      block_(gl::Buffer::create()),
      counts_(gl::Buffer::create()) {}

void ChromeSearch::search(const ChromeMapBuffer& map, const glm::dvec3& eye, std::uint32_t vertices,
                          std::size_t count, std::uint32_t results) {
    lastCount_ = static_cast<std::uint32_t>(count);
    concave_ = map.map().bend() == Bend::concave;
    counts_.replaceWith(LeftCounts{});
    if (count == 0) return;
    if (!(std::isfinite(eye.x) && std::isfinite(eye.y) && std::isfinite(eye.z))) {
        const gl::Buffer invalid =
            gl::Buffer::filled(std::span<const GpuReflection>(std::vector<GpuReflection>(count)));
        glCopyNamedBufferSubData(invalid.name(), results, 0, 0, offsetOf<GpuReflection>(count));
        return;
    }
    if (count > capacity_) {
        capacity_ = count + count / 2;
        left_ = gl::Buffer::sized(2 * capacity_ * sizeof(std::uint32_t));
    }
    block_.replaceWith(blockFor(map.map(), eye, count));
    glBindBufferBase(GL_UNIFORM_BUFFER, blockBinding, block_.name());
    const auto bind = [](GLuint binding, GLuint name) {
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, binding, name);
    };
    bind(cornersBinding, map.corners_.name());
    bind(coverageBinding, map.coverage_.name());
    bind(normalsBinding, map.normals_.name());
    bind(verticesBinding, vertices);
    bind(resultsBinding, results);
    bind(countsBinding, counts_.name());
    bind(leftBinding, left_.name());
    // On concave pieces all vertices are searched for thoroughly, as on the processor.
    thorough_.set("everyVertex", concave_ ? 1 : 0);
    if (concave_) {
        thorough_.use();
        glDispatchCompute(static_cast<GLuint>(std::min(count, mostGroups)), 1, 1);
    } else {
        constexpr GLbitfield lists = GL_SHADER_STORAGE_BARRIER_BIT | GL_COMMAND_BARRIER_BIT;
        fast_.use();
        glDispatchCompute(static_cast<GLuint>(std::min((count + groupSize - 1) / groupSize, mostGroups)), 1,
                          1);
        glMemoryBarrier(lists);
        glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, counts_.name());
        precise_.use();
        glDispatchComputeIndirect(offsetOf<LeftCount>(0));
        glMemoryBarrier(lists);
        thorough_.use();
        glDispatchComputeIndirect(offsetOf<LeftCount>(1));
        glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, 0);
    }
    glMemoryBarrier(GL_VERTEX_ATTRIB_ARRAY_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT |
                    GL_BUFFER_UPDATE_BARRIER_BIT);
    glUseProgram(0);
}

ChromeSearch::Left ChromeSearch::leftOfLast() const {
    if (concave_) return {0, lastCount_};
    LeftCounts counts{};
    glGetNamedBufferSubData(counts_.name(), 0, sizeof counts, counts.data());
    return {counts[0].count, counts[1].count};
}

std::vector<GpuReflection> ChromeSearch::read(std::uint32_t results, std::size_t count) {
    std::vector<GpuReflection> out(count);
    if (count > 0) glGetNamedBufferSubData(results, 0, offsetOf<GpuReflection>(count), out.data());
    return out;
}

}  // namespace reflection
