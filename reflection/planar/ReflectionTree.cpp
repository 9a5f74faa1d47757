#include "reflection/planar/ReflectionTree.h"

#include <algorithm>

#include "reflection/planar/TreeBuilder.h"

namespace reflection {

std::uint32_t groupCoplanar(std::span<Mirror> mirrors, double tolerance) {
    std::uint32_t groups = 0;
    std::vector<std::uint32_t> first, members;  // of each group
    std::vector<std::uint32_t> of(mirrors.size());
    for (std::uint32_t i = 0; i < mirrors.size(); ++i) {
        std::uint32_t g = 0;
        while (g < first.size() && !coplanar(mirrors[first[g]].plane, mirrors[i].plane, tolerance)) ++g;
        if (g == first.size()) {
            first.push_back(i);
            members.push_back(0);
        }
        of[i] = g;
        ++members[g];
    }
    std::vector<std::uint32_t> number(first.size(), Mirror::alone);
    for (std::uint32_t g = 0; g < first.size(); ++g)
        if (members[g] > 1) number[g] = groups++;
    for (std::uint32_t i = 0; i < mirrors.size(); ++i) mirrors[i].group = number[of[i]];
    return groups;
}

ReflectionTree reflectionTree(std::span<const TreeView> views, const ReflectionScene& scene,
                              const TreeSettings& settings) {
    ReflectionTree tree;
    const bool sound = settings.depth >= 0 && settings.depth <= 32 && settings.levelScale > 0 &&
                       settings.levelScale <= 1 && settings.faceSize > 0 && settings.texelsPerPixel > 0 &&
                       settings.texelsPerPixel <= 64 && settings.mapSize.x >= 0 && settings.mapSize.y >= 0 &&
                       settings.curvedHalfAngle > 0 && settings.curvedHalfAngle < 1.55 &&
                       std::all_of(views.begin(), views.end(),
                                   [](const TreeView& v) { return v.size.x > 0 && v.size.y > 0; });
    if (!sound) {
        tree.status = TreeStatus::badSettings;
        return tree;
    }
    TreeBuilder builder(scene, settings, tree);
    for (const TreeView& v : views) builder.addView(v);
    builder.grow();
    builder.addEnvironments();
    builder.grow();
    builder.finish();
    return tree;
}

ReflectionChildren::ReflectionChildren(const ReflectionTree& tree)
    : ofRoot(tree.roots.size()), ofNode(tree.nodes.size()) {
    for (std::uint32_t n = 0; n < tree.nodes.size(); ++n) {
        const ReflectionNode& node = tree.nodes[n];
        (node.parent == ReflectionNode::none ? ofRoot[node.root] : ofNode[node.parent]).push_back(n);
    }
}

namespace {

void emit(const ReflectionChildren& children, const std::vector<std::uint32_t>& met,
          std::vector<ReflectionStep>& steps) {
    for (std::uint32_t n : met) {
        steps.push_back({ReflectionStep::What::draw, n});
        emit(children, children.ofNode[n], steps);
        steps.push_back({ReflectionStep::What::apply, n});
    }
}

}  // namespace

std::vector<ReflectionStep> ReflectionTree::environmentSteps() const {
    const ReflectionChildren children(*this);
    std::vector<ReflectionStep> steps;
    for (std::uint32_t j = 0; j < environments.size(); ++j) {
        const EnvironmentJob& job = environments[j];
        for (std::uint32_t r = job.firstRoot; r < job.firstRoot + job.rootCount; ++r) {
            steps.push_back({ReflectionStep::What::face, r});
            emit(children, children.ofRoot[r], steps);
        }
        steps.push_back({ReflectionStep::What::publish, j});
    }
    return steps;
}

std::vector<ReflectionStep> ReflectionTree::stepsOf(std::uint32_t root) const {
    std::vector<ReflectionStep> steps;
    if (root >= roots.size()) return steps;
    const ReflectionChildren children(*this);
    emit(children, children.ofRoot[root], steps);
    return steps;
}

MapMemory paperMemory(const TreeSettings& settings, std::size_t mirrors, std::size_t curved,
                      std::uint32_t bytesPerTexel) {
    const std::uint64_t map =
        std::uint64_t(settings.mapSize.x) * static_cast<std::uint64_t>(settings.mapSize.y) * bytesPerTexel;
    const std::uint64_t face =
        std::uint64_t(settings.faceSize) * static_cast<std::uint64_t>(settings.faceSize) * bytesPerTexel;
    const std::uint64_t levels = static_cast<std::uint64_t>(std::max(settings.depth, 0)) * map;
    switch (settings.curved) {
        case CurvedMaps::none:
            return {levels, mirrors * map};
        case CurvedMaps::viewDependent:
            return {levels, (mirrors + curved) * map};
        case CurvedMaps::cube:
            return {levels + curved * 6 * face, mirrors * map + curved * 6 * face};
        case CurvedMaps::dualParaboloid:
            return {levels + curved * 2 * face, mirrors * map + curved * 2 * face};
    }
    return {};
}

}  // namespace reflection
