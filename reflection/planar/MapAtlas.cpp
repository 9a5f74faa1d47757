#include "reflection/planar/MapAtlas.h"

#include <algorithm>
#include <cmath>

namespace reflection {

namespace {

/// Shelves from below, the highest images first. False: they do not fit.
bool pack(const ReflectionTree& tree, const AtlasLimits& limits, AtlasGroup::Level& level) {
    bool rough = false;
    for (const AtlasGroup::Place& p : level.places) rough = rough || tree.nodes[p.node].roughness > 0;
    const int unit = rough ? limits.roughAlignment : 1;
    const auto sizeOf = [&](const AtlasGroup::Place& p) {
        return (tree.nodes[p.node].resolution + (unit - 1)) / unit * unit;
    };
    double area = 0;
    int widest = 1;
    std::vector<AtlasGroup::Place*> order;
    for (AtlasGroup::Place& p : level.places) {
        const glm::ivec2 size = sizeOf(p);
        area += static_cast<double>(size.x) * size.y;
        widest = std::max(widest, size.x);
        order.push_back(&p);
    }
    std::stable_sort(order.begin(), order.end(), [&](const AtlasGroup::Place* a, const AtlasGroup::Place* b) {
        return sizeOf(*a).y > sizeOf(*b).y;
    });
    const int width =
        std::max(widest, std::min(limits.most.x, static_cast<int>(std::ceil(1.1 * std::sqrt(area)))));
    glm::ivec2 at(0);
    int shelf = 0;
    level.size = glm::ivec2(0);
    for (AtlasGroup::Place* p : order) {
        const glm::ivec2 size = sizeOf(*p);
        if (at.x + size.x > width) {
            at = {0, at.y + shelf};
            shelf = 0;
        }
        p->origin = at;
        at.x += size.x;
        shelf = std::max(shelf, size.y);
        level.size = glm::max(level.size, p->origin + size);
    }
    return level.size.x <= limits.most.x && level.size.y <= limits.most.y;
}

void collect(const ReflectionChildren& children, std::uint32_t node, std::size_t depth,
             std::vector<AtlasGroup::Level>& levels) {
    if (levels.size() <= depth) levels.resize(depth + 1);
    levels[depth].places.push_back({node, glm::ivec2(0)});
    for (std::uint32_t child : children.ofNode[node]) collect(children, child, depth + 1, levels);
}

void group(const ReflectionTree& tree, const ReflectionChildren& children,
           std::span<const std::uint32_t> tops, const AtlasLimits& limits, std::vector<AtlasGroup>& groups) {
    if (tops.empty()) return;
    AtlasGroup all;
    all.tops.assign(tops.begin(), tops.end());
    for (std::uint32_t top : tops) collect(children, top, 0, all.levels);
    for (AtlasGroup::Level& level : all.levels) all.fits = all.fits && pack(tree, limits, level);
    if (all.fits) {
        groups.push_back(std::move(all));
    } else if (tops.size() == 1) {
        all.levels.clear();
        groups.push_back(std::move(all));
    } else {
        group(tree, children, tops.first(tops.size() / 2), limits, groups);
        group(tree, children, tops.subspan(tops.size() / 2), limits, groups);
    }
}

}  // namespace

std::vector<AtlasGroup> atlasGroups(const ReflectionTree& tree, const ReflectionChildren& children,
                                    std::span<const std::uint32_t> tops, const AtlasLimits& limits) {
    std::vector<AtlasGroup> groups;
    group(tree, children, tops, limits, groups);
    return groups;
}

}  // namespace reflection
