#include "city/generate/BroadleafTree.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <vector>

#include "city/generate/Random.h"
#include "city/generate/Shapes.h"

namespace city {

namespace {

constexpr double goldenTurn = 0.381966011250105;  // successive boughs turn by this: none shades the next

struct Limb {
    glm::vec3 from, to;
    float radius0, radius1;
    int order;  ///< 0 trunk, 1 bough, 2 twig
};

struct Leaf {
    glm::vec3 centre;
    glm::vec3 along;    ///< unit, stalk to tip
    glm::vec3 normal;   ///< unit, across along, on the crown's outside
    glm::vec3 shading;  ///< unit: bent towards the outside of the crown, which shades the crown as a volume
    std::uint32_t material;
};

glm::vec3 randomDirection(Random& random) {
    const float z = random.range(-1, 1);
    const Turn turn(random.uniform());
    const float r = std::sqrt(std::max(0.0f, 1 - z * z));
    return {r * turn.cos, r * turn.sin, z};
}

struct Tree {
    glm::vec3 crownCentre{0}, crownRadii{1};
    std::vector<Limb> limbs;
    std::vector<Leaf> leaves;  ///< in an order in which any beginning is spread over the whole crown
};

/// Adds a limb curved from `a` by way of `control` to `b`; returns nothing but leaves its joints in `joints`.
void growLimb(Tree& tree, std::vector<glm::vec3>& joints, const glm::vec3& a, const glm::vec3& control,
              const glm::vec3& b, float radius0, float radius1, int pieces, int order) {
    glm::vec3 last = a;
    for (int k = 1; k <= pieces; ++k) {
        const float t = static_cast<float>(k) / static_cast<float>(pieces);
        const float s = static_cast<float>(k - 1) / static_cast<float>(pieces);
        const glm::vec3 p = (1 - t) * (1 - t) * a + 2 * t * (1 - t) * control + t * t * b;
        tree.limbs.push_back(
            {last, p, radius0 + (radius1 - radius0) * s, radius0 + (radius1 - radius0) * t, order});
        joints.push_back(p);
        last = p;
    }
}

Tree growTree(const TreeShape& shape, std::size_t leafCount, Random& random) {
    Tree tree;
    const float crownHeight = shape.height - shape.crownBase;
    tree.crownCentre = {0, 0, shape.crownBase + 0.48f * crownHeight};
    tree.crownRadii = {shape.crownRadius, shape.crownRadius, 0.5f * crownHeight};

    std::vector<glm::vec3> joints;
    const glm::vec3 fork(random.range(-0.15f, 0.15f), random.range(-0.15f, 0.15f),
                         shape.crownBase + 0.12f * crownHeight);
    const glm::vec3 top(random.range(-0.4f, 0.4f), random.range(-0.4f, 0.4f),
                        shape.crownBase + 0.8f * crownHeight);
    const float r = shape.trunkRadius;
    tree.limbs.push_back({{0, 0, -0.1f}, {0, 0, 0.35f}, 1.55f * r, 1.1f * r, 0});  // root flare
    tree.limbs.push_back({{0, 0, 0.35f}, fork, 1.1f * r, 0.85f * r, 0});
    std::vector<glm::vec3> stem;
    growLimb(tree, stem, fork,
             0.5f * (fork + top) + glm::vec3(random.range(-0.3f, 0.3f), random.range(-0.3f, 0.3f), 0), top,
             0.85f * r, 0.12f * r, 4, 0);
    for (int k = 0; k < shape.boughs; ++k) {
        const float f = (static_cast<float>(k) + 0.5f) / static_cast<float>(shape.boughs);
        const Turn turn(goldenTurn * k + 0.05 * random.uniform());
        const glm::vec3 start = fork + (0.75f * f) * (top - fork);
        const float reach = 0.62f * shape.crownRadius * (1 - 0.45f * f * f);
        const glm::vec3 end(reach * turn.cos, reach * turn.sin,
                            start.z + crownHeight * random.range(0.12f, 0.26f));
        const glm::vec3 control = glm::vec3(0.55f * end.x, 0.55f * end.y, start.z + 0.03f * crownHeight);
        growLimb(tree, joints, start, control, end, 0.42f * r * (1 - 0.5f * f), 0.1f * r, 3, 1);
    }
    joints.insert(joints.end(), stem.begin(), stem.end());

    // Tufts of leaves fill the crown, most near its surface, each on a twig from the nearest joint.
    std::vector<glm::vec3> tufts;
    for (int k = 0; k < shape.clusters; ++k) {
        const glm::vec3 d = randomDirection(random);
        const float u = static_cast<float>(random.uniform());
        const float deep = 1 - 0.6f * u * u;
        // Flatter below than above.
        const float squash = d.z < 0 ? 0.8f : 1.0f;
        const glm::vec3 p =
            tree.crownCentre + deep * 0.9f * tree.crownRadii * glm::vec3(d.x, d.y, squash * d.z);
        tufts.push_back(p);
        const glm::vec3 joint =
            *std::min_element(joints.begin(), joints.end(), [&](const glm::vec3& a, const glm::vec3& b) {
                return glm::dot(a - p, a - p) < glm::dot(b - p, b - p);
            });
        tree.limbs.push_back({joint, p, 0.075f * r, 0, 2});
    }
    const float tuftRadius =
        1.05f * shape.crownRadius / std::sqrt(std::sqrt(static_cast<float>(shape.clusters)));
    tree.leaves.reserve(leafCount);
    for (std::size_t i = 0; i < leafCount; ++i) {
        const glm::vec3& tuft = tufts[i % tufts.size()];
        const float away = static_cast<float>(random.uniform());
        glm::vec3 offset = tuftRadius * (0.25f + 0.75f * away) * randomDirection(random);
        offset.z *= 0.7f;
        Leaf leaf;
        leaf.centre = tuft + offset;
        glm::vec3 e = (leaf.centre - tree.crownCentre) / tree.crownRadii;
        const float outside = glm::length(e);
        if (outside > 1) leaf.centre = tree.crownCentre + (leaf.centre - tree.crownCentre) / outside;
        const glm::vec3 out = glm::normalize(leaf.centre - tree.crownCentre + glm::vec3(0, 0, 1e-3f));
        glm::vec3 normal = glm::normalize(randomDirection(random) + 0.6f * out + glm::vec3(0, 0, 0.55f) +
                                          glm::vec3(1e-4f, 0, 0));
        if (glm::dot(normal, out) < 0) normal = -normal;
        glm::vec3 along = glm::cross(normal, randomDirection(random));
        const float length = glm::length(along);
        along = length > 1e-3f ? along / length
                               : glm::normalize(glm::cross(normal, glm::vec3(normal.y, normal.z, normal.x) +
                                                                       glm::vec3(0, 0.1f, 0.2f)));
        leaf.along = along;
        leaf.normal = normal;
        const glm::vec3 tuftOut = glm::normalize(offset + glm::vec3(0, 0, 0.4f * tuftRadius));
        leaf.shading = glm::normalize(0.45f * normal + 0.6f * out + 0.5f * tuftOut + glm::vec3(0, 0, 0.15f));
        // Sunlit, outer leaves brighter than those inside; a few warm ones.
        const double bright = 0.25 + 0.5 * std::min(outside, 1.0f) + 0.15 * static_cast<double>(out.z);
        leaf.material = random.chance(0.12)     ? shape.foliage[2]
                        : random.chance(bright) ? shape.foliage[0]
                                                : shape.foliage[1];
        tree.leaves.push_back(leaf);
    }
    return tree;
}

/// A leaf folded along its rib: two triangles that share the rib.
void addLeaf(Mesh& mesh, const Tree& tree, const Leaf& leaf, float length, bool half) {
    const glm::vec3 inwards = tree.crownCentre - leaf.centre;
    // Enlarged leaves move inwards, so that the crown does not grow with them.
    const float pull = std::min(0.4f, 0.35f * length / tree.crownRadii.x);
    const glm::vec3 centre = leaf.centre + pull * inwards;
    const glm::vec3 across = glm::cross(leaf.normal, leaf.along);
    const float width = 0.62f * length;
    const glm::vec3 stalk = centre - 0.5f * length * leaf.along, tip = centre + 0.5f * length * leaf.along;
    const glm::vec3 fold = 0.12f * length * leaf.normal - 0.08f * length * leaf.along;
    const glm::vec3 left = centre + 0.5f * width * across + fold,
                    right = centre - 0.5f * width * across + fold;
    const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.push_back({stalk, leaf.shading, {0.5f, 0}, leaf.material});
    mesh.vertices.push_back({right, leaf.shading, {1, 0.5f}, leaf.material});
    mesh.vertices.push_back({tip, leaf.shading, {0.5f, 1}, leaf.material});
    mesh.indices.insert(mesh.indices.end(), {base, base + 1, base + 2});
    if (half) return;
    mesh.vertices.push_back({left, leaf.shading, {0, 0.5f}, leaf.material});
    mesh.indices.insert(mesh.indices.end(), {base, base + 2, base + 3});
}

/// Area of a leaf of length 1: two triangles over a rib of 1, each about half the width high.
constexpr float leafArea = 0.31f;

}  // namespace

Prototype makeBroadleafTree(std::string name, const TreeShape& shape, std::span<const std::size_t> triangles,
                            std::uint64_t seed) {
    Prototype prototype;
    prototype.name = std::move(name);
    if (triangles.empty()) return prototype;
    Random random(seed);
    const Tree tree = growTree(shape, triangles.front() / 2, random);
    const float leafTotal = shape.leafCoverage * 3.1416f * shape.crownRadius * shape.crownRadius;

    for (const std::size_t wanted : triangles) {
        Prototype::Level level;
        // Sides of trunk, boughs and twigs, as many as the level can carry beside its leaves; 0: left out.
        const bool fine = wanted >= 20000, middle = wanted >= 2500;
        const int sides[3] = {fine             ? 12
                              : middle         ? 8
                              : wanted >= 1000 ? 6
                              : wanted >= 200  ? 4
                                               : 3,
                              fine             ? 7
                              : middle         ? 4
                              : wanted >= 1000 ? 3
                                               : 0,
                              fine     ? 4
                              : middle ? 3
                                       : 0};
        for (const Limb& limb : tree.limbs) {
            if (sides[limb.order] == 0) continue;
            if (wanted < 200 && limb.to.z > shape.crownBase + 0.15f * (shape.height - shape.crownBase))
                continue;
            addTube(level.mesh, limb.from, limb.to, limb.radius0, limb.radius1, sides[limb.order],
                    shape.bark);
        }
        const std::size_t wood = level.mesh.triangleCount();
        const std::size_t rest = wanted > wood ? wanted - wood : 0;
        const std::size_t leaves = std::min(tree.leaves.size(), (rest + 1) / 2);
        const float length =
            std::sqrt(leafTotal / (leafArea * static_cast<float>(std::max<std::size_t>(leaves, 1))));
        for (std::size_t i = 0; i < leaves; ++i)
            addLeaf(level.mesh, tree, tree.leaves[i], length, i + 1 == leaves && rest % 2 == 1);
        level.error = prototype.levels.empty() ? 0 : length;
        prototype.levels.push_back(std::move(level));
    }
    return prototype;
}

}  // namespace city
