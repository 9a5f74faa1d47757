#include "app/mirrors/MirrorWorld.h"

#include <algorithm>
#include <glm/trigonometric.hpp>
#include <random>

#include "app/mirrors/LitShapes.h"

namespace app {

std::size_t MirrorWorld::triangles() const {
    std::size_t n = 0;
    for (const LitMesh& m : objects) n += m.triangles();
    for (const Flat& f : mirrors) n += f.mirror.plane.corners().size() - 2;
    for (const Curved& c : curved) n += c.mesh.triangles();
    return n;
}

bool MirrorWorld::needsDistances() const {
    return std::ranges::any_of(mirrors, [](const Flat& f) { return f.ripples.any(); });
}

reflection::TreeView MirrorWorld::view(const glm::ivec2& size) const {
    return {reflection::perspectiveView(eye, target, glm::radians(fovYDegrees),
                                        static_cast<double>(size.x) / std::max(size.y, 1), 0.05),
            size};
}

MirrorWorldScene::MirrorWorldScene(const MirrorWorld& world) : occluders(world.occluders) {
    for (const MirrorWorld::Flat& f : world.mirrors) mirrors.push_back(f.mirror);
    for (const MirrorWorld::Curved& c : world.curved) curved.push_back(c.reflector);
    for (const LitMesh& m : world.objects) objects.push_back(m.bounds());
}

reflection::ReflectionScene MirrorWorldScene::scene() const {
    reflection::ReflectionScene s;
    s.mirrors = mirrors;
    s.curved = curved;
    s.objects = objects;
    s.occluders = occluders;
    return s;
}

namespace {

void addMirror(MirrorWorld& world, const std::vector<glm::dvec3>& corners,
               const reflection::MirrorSurface& surface, const glm::vec3& tint) {
    world.mirrors.push_back({{world.mirrors.size(), reflection::MirrorPlane::make(corners, surface).mirror,
                              reflection::Mirror::alone},
                             tint,
                             {},
                             0});
}

void add(MirrorWorld& world, LitMesh mesh) {
    bakeLight(mesh);
    world.objects.push_back(std::move(mesh));
}

void addSolid(MirrorWorld& world, const glm::vec3& low, const glm::vec3& high, const glm::vec3& colour) {
    add(world, litBox(low, high, colour));
    world.occluders.push_back(world.objects.back().bounds());
}

/// Own distribution: the standard's differ between libraries.
double between(std::mt19937_64& engine, double a, double b) {
    return a + (b - a) * static_cast<double>(engine() >> 11) * 0x1p-53;
}

}  // namespace

MirrorWorld streetOfWindows(std::uint32_t windows, std::uint64_t seed) {
    MirrorWorld world;
    world.name = "street of " + std::to_string(windows) + " windows";
    world.depth = 2;
    std::mt19937_64 random(seed);
    const std::uint32_t aSide = (windows + 1) / 2;
    const float pitch = 4.f, half = 6.f, length = pitch * static_cast<float>(aSide);
    const reflection::MirrorSurface glass{glm::vec3(0.55f), 0};
    add(world, litPanel({-10, -half, 0}, {length + 20, 0, 0}, {0, 2 * half, 0}, 2 * static_cast<int>(aSide),
                        6, {0.45f, 0.44f, 0.42f}, {0.38f, 0.38f, 0.4f}));
    std::uint32_t made = 0;
    for (int side = 0; side < 2; ++side) {
        const float y = side == 0 ? half : -half, out = side == 0 ? -1.f : 1.f;
        for (std::uint32_t i = 0; i < aSide; ++i) {
            const float x = pitch * static_cast<float>(i);
            const glm::vec3 wall(static_cast<float>(between(random, 0.3, 0.8)),
                                 static_cast<float>(between(random, 0.3, 0.7)),
                                 static_cast<float>(between(random, 0.25, 0.6)));
            // The house stands back by a little that differs from shop to shop: few windows are coplanar.
            const float depth = 0.1f * static_cast<float>(static_cast<int>(between(random, 0, 6)));
            const float face = y - out * depth;
            addSolid(world, {x, std::min(face, face - 4 * out), 0},
                     {x + pitch, std::max(face, face - 4 * out), static_cast<float>(between(random, 6, 14))},
                     wall);
            for (int storey = 0; storey < 2; ++storey)
                add(world, litPanel({x + (side == 0 ? 0.6f : pitch - 0.6f), face + 0.02f * out,
                                     3.6f + 2.2f * static_cast<float>(storey)},
                                    {side == 0 ? 2.8f : -2.8f, 0, 0}, {0, 0, 1.2f}, 4, 3, {0.25f, 0.3f, 0.4f},
                                    {0.7f, 0.7f, 0.65f}));
            if (made == windows) continue;
            ++made;
            const double a = x + 0.4, b = x + pitch - 0.4, wy = face + 0.05 * out;
            const std::vector<glm::dvec3> front{{a, wy, 0.5}, {b, wy, 0.5}, {b, wy, 3}, {a, wy, 3}};
            std::vector<glm::dvec3> corners = front;
            if (side == 1) corners = {front[1], front[0], front[3], front[2]};
            addMirror(world, corners, glass, {0.06f, 0.08f, 0.09f});
            if (i % 3 == 1) add(world, litPillar({x, y + 1.6f * out, 0}, 0.12f, 4, 12, {0.2f, 0.3f, 0.25f}));
            if (i % 4 == 2)
                add(world,
                    litBox({x + 0.3f, y + 2.2f * out - 0.8f, 0.2f}, {x + 3.9f, y + 2.2f * out + 0.8f, 1.4f},
                           {static_cast<float>(between(random, 0.2, 0.9)),
                            static_cast<float>(between(random, 0.1, 0.6)), 0.2f}));
        }
    }
    world.eye = {2, -1.5, 1.7};
    world.target = {14, 1, 1.9};
    return world;
}

MirrorWorld facingWindows(float roughness) {
    MirrorWorld world;
    world.name = "facing windows";
    world.depth = 8;
    const reflection::MirrorSurface glass{glm::vec3(0.85f, 0.88f, 0.86f), roughness};
    addMirror(world, {{-2, 2, 0.2}, {2, 2, 0.2}, {2, 2, 2.8}, {-2, 2, 2.8}}, glass, {0.05f, 0.06f, 0.06f});
    addMirror(world, {{2, -2, 0.2}, {-2, -2, 0.2}, {-2, -2, 2.8}, {2, -2, 2.8}}, glass,
              {0.05f, 0.06f, 0.06f});
    add(world, litPanel({-6, -2.2f, 0}, {12, 0, 0}, {0, 4.4f, 0}, 12, 4, {0.55f, 0.5f, 0.45f},
                        {0.35f, 0.33f, 0.32f}));
    add(world, litBox({-2.6f, 2.01f, 0}, {2.6f, 2.3f, 3.4f}, {0.6f, 0.42f, 0.33f}));
    add(world, litBox({-2.6f, -2.3f, 0}, {2.6f, -2.01f, 3.4f}, {0.4f, 0.47f, 0.55f}));
    add(world, litBall({0.5f, 0.6f, 0.6f}, 0.35f, 32, 16, {0.85f, 0.25f, 0.15f}));
    add(world, litBox({-1.3f, 0.7f, 0}, {-0.9f, 1.1f, 1.3f}, {0.2f, 0.5f, 0.75f}));
    add(world, litPillar({1.4f, -0.6f, 0}, 0.1f, 2.4f, 16, {0.85f, 0.75f, 0.3f}));
    world.eye = {-1.1, -1.35, 1.65};
    world.target = {0.35, 2, 1.2};
    world.fovYDegrees = 65;
    return world;
}

}  // namespace app
