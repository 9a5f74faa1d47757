#include "reflection/chrome/VirtualTriangles.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace reflection {

double apartOf(const glm::vec3& a, const glm::vec3& b) {
    return glm::length(glm::normalize(glm::dvec3(a)) - glm::normalize(glm::dvec3(b)));
}

double angleToArc(const glm::dvec3& towards, const glm::dvec3& a, const glm::dvec3& b) {
    const glm::dvec3 u = glm::normalize(a), v = glm::normalize(b), up = glm::cross(u, v);
    double best = std::max(glm::dot(u, towards), glm::dot(v, towards));
    const double area = glm::dot(up, up);
    if (area > 1e-20) {
        const glm::dvec3 flat = towards - glm::dot(towards, up) / area * up;
        if (glm::dot(glm::cross(u, flat), up) > 0 && glm::dot(glm::cross(flat, v), up) > 0)
            best = std::max(best, glm::length(flat));
    }
    return std::acos(std::clamp(best, -1.0, 1.0));
}

void cutTriangle(const VirtualTriangle& t, const VirtualTriangle& middle, std::vector<VirtualTriangle>& out) {
    int halved = 0;
    for (const std::uint32_t m : middle) halved += m != straightEdge;
    if (halved == 3) {
        out.push_back({t[0], middle[0], middle[2]});
        out.push_back({middle[0], t[1], middle[1]});
        out.push_back({middle[2], middle[1], t[2]});
        out.push_back({middle[0], middle[1], middle[2]});
        return;
    }
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t next = (k + 1) % 3, last = (k + 2) % 3;
        if (halved == 1 && middle[k] != straightEdge) {
            out.push_back({t[k], middle[k], t[last]});
            out.push_back({middle[k], t[next], t[last]});
        } else if (halved == 2 && middle[k] == straightEdge) {
            out.push_back({t[last], middle[last], middle[next]});
            out.push_back({middle[last], t[k], t[next]});
            out.push_back({middle[last], t[next], middle[next]});
        }
    }
}

}  // namespace reflection
