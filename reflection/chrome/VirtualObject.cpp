#include "reflection/chrome/VirtualObject.h"

#include <cmath>
#include <utility>

namespace reflection {

namespace {

bool finite(const glm::vec3& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

/// On the line of sight through the point, at the length of the path. For a point that was found this is the
/// vertex mirrored at the tangent plane; for a hidden one, too, where the line of sight meets the surface.
glm::vec3 imageOf(const ReflectionPoint& r, const glm::dvec3& eye, const glm::dvec3& vertex) {
    return glm::vec3(virtualVertex(r, vertex) - eye);
}

void count(VirtualCounts& counts, const ReflectionPoint& r) {
    ++counts.searched;
    counts.lookups += r.lookups;
    counts.found += r.status == ReflectionStatus::found;
    counts.hidden += r.status == ReflectionStatus::hidden;
    counts.unreflected += r.status == ReflectionStatus::unreflected;
}

}  // namespace

void findReflectionPoints(const ReflectorMap& map, const glm::dvec3& eye,
                          std::span<const glm::dvec3> vertices, std::span<ReflectionPoint> points,
                          const VirtualOptions& options) {
    if (options.published)
        findReflectionPointsAsPublished(map, eye, vertices, points, *options.published);
    else
        findReflectionPoints(map, eye, vertices, points, options.search);
}

VirtualObject::VirtualObject(std::vector<glm::vec3> positions, const VirtualOptions& options)
    : settings(options), points(std::move(positions)) {
    image.resize(points.size());
    for (std::uint32_t k = 0; k < points.size(); ++k)
        if (!finite(points[k])) broken.push_back(k);
    const double most = settings.share * static_cast<double>(points.size());
    // Below the eight nodes of one cell there is nothing to interpolate between.
    if (settings.share < 1 && most >= 8) grid.emplace(points, static_cast<std::size_t>(most));
}

VirtualCounts VirtualObject::update(const ReflectorMap& map, const glm::dvec3& eye,
                                    const glm::dmat4& reflectorFromMesh) {
    VirtualCounts counts;
    counts.vertices = points.size();
    const auto place = [&](const glm::vec3& p) {
        return glm::dvec3(reflectorFromMesh * glm::dvec4(glm::dvec3(p), 1));
    };
    exact.clear();
    if (grid) {
        const std::span<const glm::vec3> nodes = grid->nodes();
        counts.nodes = nodes.size();
        asked.resize(nodes.size());
        answers.resize(nodes.size());
        for (std::size_t k = 0; k < nodes.size(); ++k) asked[k] = place(nodes[k]);
        findReflectionPoints(map, eye, asked, answers, settings);
        atNodes.resize(nodes.size());
        for (std::size_t k = 0; k < nodes.size(); ++k) {
            count(counts, answers[k]);
            atNodes[k] = glm::vec4(imageOf(answers[k], eye, asked[k]), 0);
        }
        atVertices.resize(points.size());
        grid->interpolate(atNodes, atVertices);
        const std::span<const BoundingGrid::Cell> cells = grid->cells();
        cellStatus.resize(cells.size());
        for (std::size_t k = 0; k < cells.size(); ++k) {
            ReflectionStatus status = answers[cells[k].nodes[0]].status;
            for (const std::uint32_t n : cells[k].nodes)
                if (answers[n].status != status) status = ReflectionStatus::invalid;
            cellStatus[k] = status;
        }
        const std::span<const BoundingGrid::Place> places = grid->places();
        for (std::size_t k = 0; k < points.size(); ++k) {
            const ReflectionStatus status = cellStatus[places[k].cell];
            image[k] = {glm::vec3(atVertices[k]), status};
            if (status == ReflectionStatus::invalid && settings.exactAtOutlines)
                exact.push_back(static_cast<std::uint32_t>(k));
        }
        counts.atOutlines = exact.size();
    } else {
        for (std::size_t k = 0; k < points.size(); ++k) exact.push_back(static_cast<std::uint32_t>(k));
    }
    asked.resize(exact.size());
    answers.resize(exact.size());
    for (std::size_t k = 0; k < exact.size(); ++k) asked[k] = place(points[exact[k]]);
    findReflectionPoints(map, eye, asked, answers, settings);
    for (std::size_t k = 0; k < exact.size(); ++k) {
        count(counts, answers[k]);
        image[exact[k]] = {imageOf(answers[k], eye, asked[k]), answers[k].status};
    }
    for (const std::uint32_t k : broken) image[k] = {};
    return counts;
}

}  // namespace reflection
