#include "reflection/chrome/VirtualObject.h"

#include <algorithm>
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

double apart(const glm::vec3& a, const glm::vec3& b) {
    return static_cast<double>(glm::length(glm::normalize(a) - glm::normalize(b)));
}

void count(VirtualCounts& counts, const ReflectionPoint& r) {
    ++counts.searched;
    counts.lookups += r.lookups;
    counts.found += r.status == ReflectionStatus::found;
    counts.hidden += r.status == ReflectionStatus::hidden;
    counts.unreflected += r.status == ReflectionStatus::unreflected;
}

}  // namespace

glm::dvec3 reflectionPointOf(const VirtualVertex& seen, const glm::dvec3& eye, const glm::dvec3& vertex) {
    // |eye + s u - vertex| = path - s, solved for s.
    const glm::dvec3 path(seen.fromEye), away = eye - vertex;
    const double length = glm::length(path), straight = glm::length(away);
    const glm::dvec3 u = path / std::max(length, 1e-300);
    const double by = 2 * (length + glm::dot(u, away));
    if (!(by > 0)) return eye;
    const double s = (length - straight) * (length + straight) / by;
    return eye + std::clamp(s, 0.0, length) * u;
}

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
    if (!(settings.share < 1 && most >= 8)) return;
    grid.emplace(points, static_cast<std::size_t>(most));
    probes.assign(grid->cells().size(), 0);
    std::vector<float> farthest(probes.size(), -1);
    for (std::uint32_t k = 0; k < points.size(); ++k) {
        const BoundingGrid::Place& p = grid->places()[k];
        // What trilinear interpolation leaves out grows as this.
        const glm::vec3 bump = p.within * (1.0f - p.within);
        const float far = bump.x + bump.y + bump.z;
        if (!(far > farthest[p.cell])) continue;
        farthest[p.cell] = far;
        probes[p.cell] = k;
    }
}

void VirtualObject::searchExactly(const ReflectorMap& map, const glm::dvec3& eye,
                                  const glm::dmat4& reflectorFromMesh, VirtualCounts& counts) {
    asked.resize(exact.size());
    answers.resize(exact.size());
    for (std::size_t k = 0; k < exact.size(); ++k)
        asked[k] = glm::dvec3(reflectorFromMesh * glm::dvec4(glm::dvec3(points[exact[k]]), 1));
    findReflectionPoints(map, eye, asked, answers, settings);
    for (std::size_t k = 0; k < exact.size(); ++k) {
        count(counts, answers[k]);
        image[exact[k]] = {imageOf(answers[k], eye, asked[k]), answers[k].status};
    }
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
        searchCell.assign(cells.size(), 0);
        // Images bend about as the reflector's outline does, as in VirtualMesh.
        const double reach =
            map.frame().scale * map.outerRadius() / std::max(glm::length(eye - map.frame().centre), 1e-300);
        const double unbent = std::sqrt(settings.cellTolerance * std::asin(std::min(reach, 1.0)));
        for (std::size_t k = 0; k < cells.size(); ++k) {
            const std::array<std::uint32_t, 8>& n = cells[k].nodes;
            ReflectionStatus status = answers[n[0]].status;
            for (const std::uint32_t i : n)
                if (answers[i].status != status) status = ReflectionStatus::invalid;
            cellStatus[k] = status;
            if (status != ReflectionStatus::found) continue;
            double span = 0;
            for (std::size_t i = 0; i < 4; ++i)
                span = std::max(span, apart(glm::vec3(atNodes[n[i]]), glm::vec3(atNodes[n[7 - i]])));
            searchCell[k] = span > unbent;
        }
        const std::span<const BoundingGrid::Place> places = grid->places();
        for (std::size_t k = 0; k < points.size(); ++k) {
            const std::uint32_t cell = places[k].cell;
            const ReflectionStatus status = cellStatus[cell];
            image[k] = {glm::vec3(atVertices[k]), status};
            if (status == ReflectionStatus::invalid && settings.exactAtOutlines)
                exact.push_back(static_cast<std::uint32_t>(k));
            else if (searchCell[cell] != 0 && probes[cell] == k)
                exact.push_back(static_cast<std::uint32_t>(k));
        }
        searchExactly(map, eye, reflectorFromMesh, counts);
        for (std::size_t k = 0; k < cells.size(); ++k) {
            if (searchCell[k] == 0) continue;
            ++counts.inBentCells;
            const std::uint32_t probe = probes[k];
            searchCell[k] =
                image[probe].status != cellStatus[k] ||
                apart(glm::vec3(atVertices[probe]), image[probe].fromEye) > settings.cellTolerance;
        }
        counts.atOutlines = exact.size() - counts.inBentCells;
        exact.clear();
        for (std::size_t k = 0; k < points.size(); ++k)
            if (searchCell[places[k].cell] != 0 && probes[places[k].cell] != k)
                exact.push_back(static_cast<std::uint32_t>(k));
        counts.inBentCells += exact.size();
    } else {
        for (std::size_t k = 0; k < points.size(); ++k) exact.push_back(static_cast<std::uint32_t>(k));
    }
    searchExactly(map, eye, reflectorFromMesh, counts);
    for (const std::uint32_t k : broken) image[k] = {};
    return counts;
}

}  // namespace reflection
