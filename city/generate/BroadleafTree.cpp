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

enum class LeafCut : std::uint8_t { folded, single };

/// A leaf folded along its rib, two triangles that share the rib; or one triangle of the same area.
void addLeaf(Mesh& mesh, const Tree& tree, const Leaf& leaf, float length, LeafCut cut) {
    const glm::vec3 inwards = tree.crownCentre - leaf.centre;
    // Enlarged leaves move inwards, so that the crown does not grow with them.
    const float pull = std::min(0.4f, 0.35f * length / tree.crownRadii.x);
    const glm::vec3 centre = leaf.centre + pull * inwards;
    const glm::vec3 across = glm::cross(leaf.normal, leaf.along);
    const float width = 0.62f * length;
    const glm::vec3 stalk = centre - 0.5f * length * leaf.along, tip = centre + 0.5f * length * leaf.along;
    const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
    if (cut == LeafCut::single) {
        const glm::vec3 foot = centre - 0.4f * length * leaf.along;
        mesh.vertices.push_back({foot + 0.5f * width * across, leaf.shading, {0.1f, 0.2f}, leaf.material});
        mesh.vertices.push_back({foot - 0.5f * width * across, leaf.shading, {0.9f, 0.2f}, leaf.material});
        mesh.vertices.push_back({tip + 0.1f * length * leaf.along, leaf.shading, {0.5f, 1}, leaf.material});
        mesh.indices.insert(mesh.indices.end(), {base, base + 1, base + 2});
        return;
    }
    const glm::vec3 fold = 0.12f * length * leaf.normal - 0.08f * length * leaf.along;
    const glm::vec3 left = centre + 0.5f * width * across + fold,
                    right = centre - 0.5f * width * across + fold;
    mesh.vertices.push_back({stalk, leaf.shading, {0.5f, 0}, leaf.material});
    mesh.vertices.push_back({right, leaf.shading, {1, 0.5f}, leaf.material});
    mesh.vertices.push_back({tip, leaf.shading, {0.5f, 1}, leaf.material});
    mesh.vertices.push_back({left, leaf.shading, {0, 0.5f}, leaf.material});
    mesh.indices.insert(mesh.indices.end(), {base, base + 1, base + 2, base, base + 2, base + 3});
}

/// The shaded inside of the crown (to `share` of its radii), which fine trees fill with leaves and coarse
/// ones cannot afford to: a lumpy ball, darker than the leaves in front of it.
void addCore(Mesh& mesh, const Tree& tree, float share, int around, int rings, std::uint32_t material) {
    const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
    for (int j = 0; j <= rings; ++j) {
        const Turn polar(0.5 * j / rings - 0.25);
        for (int i = 0; i < around; ++i) {
            const Turn turn(static_cast<double>(i) / around + 0.5 * (j % 2) / around);
            const glm::vec3 d(polar.cos * turn.cos, polar.cos * turn.sin, polar.sin);
            // Lumps that depend on the direction alone, so that all levels share them.
            const float lump = 1 + 0.17f * Turn(static_cast<double>(1.3f * d.x + 0.9f * d.z)).sin +
                               0.14f * Turn(static_cast<double>(1.1f * d.y - 0.7f * d.x)).cos;
            mesh.vertices.push_back(
                {tree.crownCentre + share * lump * tree.crownRadii * d, d, {d.x, d.z}, material});
        }
    }
    const auto at = [&](int i, int j) { return base + static_cast<std::uint32_t>(j * around + i % around); };
    for (int j = 0; j < rings; ++j) {
        for (int i = 0; i < around; ++i) {
            // Odd rings are turned by half a step.
            const int shift = j % 2;
            if (j > 0)
                mesh.indices.insert(mesh.indices.end(), {at(i, j), at(i + 1, j), at(i + shift, j + 1)});
            if (j + 1 < rings)
                mesh.indices.insert(mesh.indices.end(),
                                    {at(i + 1 - shift, j), at(i + 1, j + 1), at(i, j + 1)});
        }
    }
}

/// Area of a leaf of length 1, of either cut: half its width.
constexpr float leafArea = 0.31f;

/// A leaf that is drawn larger than its real neighbours moves the crown's outline by a part of its length.
constexpr float errorOfLength = 0.6f;

}  // namespace

Prototype makeBroadleafTree(std::string name, const TreeShape& shape, std::span<const std::size_t> triangles,
                            std::uint64_t seed) {
    Prototype prototype;
    prototype.name = std::move(name);
    if (triangles.empty()) return prototype;
    Random random(seed);
    // As many leaves as any level can show.
    std::size_t leafCount = 0;
    for (const std::size_t n : triangles) {
        leafCount = std::max(leafCount, n);
    }
    const Tree tree = growTree(shape, leafCount, random);
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
        if (!fine) {
            const int around = wanted >= 500 ? 12 : wanted >= 150 ? 8 : 6;
            const int rings = wanted >= 500 ? 6 : wanted >= 150 ? 4 : 3;
            // The more leaves, the less of it shows.
            const float share = prototype.levels.empty() ? 0.52f : wanted >= 500 ? 0.6f : 0.66f;
            addCore(level.mesh, tree, share, around, rings, shape.core);
        }
        const std::size_t wood = level.mesh.triangleCount();
        const std::size_t rest = wanted > wood ? wanted - wood : 0;
        const LeafCut cut = prototype.levels.empty() ? LeafCut::folded : LeafCut::single;
        const std::size_t leaves = cut == LeafCut::folded ? (rest + 1) / 2 : rest;
        const float length =
            std::sqrt(leafTotal / (leafArea * static_cast<float>(std::max<std::size_t>(leaves, 1))));
        for (std::size_t i = 0; i < leaves; ++i) {
            const bool odd = cut == LeafCut::folded && i + 1 == leaves && rest % 2 == 1;
            addLeaf(level.mesh, tree, tree.leaves[i], length, odd ? LeafCut::single : cut);
        }
        level.error = prototype.levels.empty() ? 0 : errorOfLength * length;
        prototype.levels.push_back(std::move(level));
    }
    return prototype;
}

}  // namespace city
