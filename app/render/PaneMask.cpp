#include "app/render/PaneMask.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>

namespace app {

namespace gl = reflection::gl;

namespace {

/// Texels around panes; see PaneMask::draw.
constexpr double border = 2;
/// Of clip space: what lies nearer is at the eye, what lies farther out is not seen.
constexpr double leastW = 1e-3, farthestOut = 1.1;

/// Sutherland and Hodgman in homogeneous coordinates: keeps where dot(plane, p) >= offset.
void cut(std::vector<glm::dvec4>& polygon, const glm::dvec4& plane, double offset) {
    std::vector<glm::dvec4> left;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const glm::dvec4 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
        const double da = glm::dot(plane, a) - offset, db = glm::dot(plane, b) - offset;
        if (da >= 0) left.push_back(a);
        if ((da >= 0) != (db >= 0)) left.push_back(a + da / (da - db) * (b - a));
    }
    polygon = std::move(left);
}

double turn(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Convex hull, counter-clockwise (Andrew's monotone chain).
std::vector<glm::dvec2> hullOf(std::vector<glm::dvec2> points) {
    std::ranges::sort(
        points, [](const glm::dvec2& a, const glm::dvec2& b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
    std::vector<glm::dvec2> hull;
    for (int side = 0; side < 2; ++side) {
        const std::size_t first = hull.size();
        for (const glm::dvec2& p : points) {
            while (hull.size() >= first + 2 && turn(hull[hull.size() - 2], hull.back(), p) <= 0)
                hull.pop_back();
            hull.push_back(p);
        }
        hull.pop_back();  // the other side begins with it
        std::ranges::reverse(points);
    }
    return hull;
}

}  // namespace

std::vector<glm::vec2> shownPart(std::span<const glm::dvec3> outline, const reflection::ReflectionNode& node,
                                 double texels) {
    std::vector<glm::dvec4> polygon;
    for (const glm::dvec3& corner : outline) {
        const glm::dvec4 clip =
            node.clipFromView * glm::dvec4(node.view.viewFromWorld * (corner - node.view.eye), 1);
        if (!std::isfinite(glm::dot(clip, clip))) return {};
        polygon.push_back(clip);
    }
    cut(polygon, {0, 0, 0, 1}, leastW);
    for (const double side : {-1.0, 1.0}) {
        cut(polygon, {side, 0, 0, farthestOut}, 0);
        cut(polygon, {0, side, 0, farthestOut}, 0);
    }
    if (polygon.size() < 3) return {};
    // Moved to the corners of a square: the hull of these is all that is so near.
    const glm::dvec2 step = 2 * texels / glm::dvec2(glm::max(node.resolution, glm::ivec2(1)));
    std::vector<glm::dvec2> around;
    for (const glm::dvec4& p : polygon)
        for (const double x : {-step.x, step.x})
            for (const double y : {-step.y, step.y}) around.push_back(glm::dvec2(p) / p.w + glm::dvec2(x, y));
    std::vector<glm::vec2> shown;
    for (const glm::dvec2& p : hullOf(std::move(around))) shown.emplace_back(p);
    return shown;
}

PaneMask::PaneMask(std::span<const city::GlassFront> fronts)
    : program_(gl::Program::fromFiles({"pane_mask.vert", "depth.frag"})),
      corners_(gl::Buffer::create()),
      array_(gl::VertexArray::create()) {
    for (const city::GlassFront& front : fronts) outlines_.push_back(front.outline);
}

void PaneMask::draw(const reflection::ReflectionNode& node, std::span<const std::uint32_t> fronts) {
    triangles_.clear();
    for (const std::uint32_t f : fronts) {
        if (f >= outlines_.size()) continue;
        const std::vector<glm::vec2> shown = shownPart(outlines_[f], node, border);
        for (std::size_t i = 2; i < shown.size(); ++i)
            triangles_.insert(triangles_.end(), {shown[0], shown[i - 1], shown[i]});
    }
    if (triangles_.empty()) return;
    // As near as can be, but for the panes, which are as far as can be.
    glClearDepth(1);
    glClear(GL_DEPTH_BUFFER_BIT);
    glClearDepth(0);
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    glDepthFunc(GL_ALWAYS);
    glDisable(GL_CULL_FACE);
    corners_.replace(std::span<const glm::vec2>(triangles_));
    array_.buffer(0, corners_.name(), sizeof(glm::vec2)).attribute(0, 0, 2, GL_FLOAT, false, 0);
    program_.use();
    array_.bind();
    glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(triangles_.size()));
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glDepthFunc(GL_GEQUAL);
}

}  // namespace app
