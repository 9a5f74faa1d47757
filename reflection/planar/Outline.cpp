#include "reflection/planar/Outline.h"

namespace reflection {

std::vector<glm::dvec2> projected(const EyeView& view, const std::vector<glm::dvec3>& relative) {
    const glm::dmat4 clipFromRelative = view.clipFromRelative();
    std::vector<glm::dvec2> corners;
    for (const glm::dvec3& p : relative) {
        const glm::dvec4 c = clipFromRelative * glm::dvec4(p, 1);
        if (!(c.w > 0)) return {};
        corners.emplace_back(glm::dvec2(c) / c.w);
    }
    return corners;
}

std::vector<glm::dvec2> widened(const std::vector<glm::dvec2>& polygon, const glm::dvec2& texels,
                                double margin) {
    std::vector<glm::dvec2> p;
    for (const glm::dvec2& c : polygon)
        if (p.empty() || glm::distance(p.back(), c * texels) > 1e-6) p.push_back(c * texels);
    while (p.size() > 1 && glm::distance(p.front(), p.back()) <= 1e-6) p.pop_back();
    if (p.size() < 3) return {};
    double twice = 0;
    for (std::size_t i = 0; i < p.size(); ++i) {
        const glm::dvec2 &a = p[i], &b = p[(i + 1) % p.size()];
        twice += a.x * b.y - a.y * b.x;
    }
    const double out = twice < 0 ? -1 : 1;
    std::vector<glm::dvec2> wider;
    for (std::size_t i = 0; i < p.size(); ++i) {
        const glm::dvec2 into = glm::normalize(p[i] - p[(i + p.size() - 1) % p.size()]),
                         from = glm::normalize(p[(i + 1) % p.size()] - p[i]);
        const glm::dvec2 n1 = out * glm::dvec2(into.y, -into.x), n2 = out * glm::dvec2(from.y, -from.x);
        const double together = glm::dot(n1, n2);
        if (together >= 0) {
            wider.push_back(p[i] + margin / (1 + together) * (n1 + n2));
        } else {
            // Two corners, lest a sharp one reach far.
            wider.push_back(p[i] + margin * (n1 + into));
            wider.push_back(p[i] + margin * (n2 - from));
        }
    }
    for (glm::dvec2& c : wider) c /= texels;
    return wider;
}

}  // namespace reflection
