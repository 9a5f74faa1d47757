#include "app/mirrors/MirrorTruth.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "reflection/truth/TracedScene.h"

namespace app {

namespace {

using reflection::TracedHit;
using reflection::TracedRay;

/// splitmix64 (Steele, Lea, Flood 2014).
struct Random {
    std::uint64_t state;
    double unit() {
        std::uint64_t z = (state += 0x9e3779b97f4a7c15ULL);
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
        return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
    }
};

city::Mesh plainMesh(const std::vector<glm::vec3>& positions, const std::vector<std::uint32_t>& indices) {
    city::Mesh mesh;
    for (const glm::vec3& p : positions) {
        city::Vertex v;
        v.position = p;
        mesh.vertices.push_back(v);
    }
    mesh.indices = indices;
    return mesh;
}

city::Mesh plainMesh(const LitMesh& lit) {
    std::vector<glm::vec3> positions;
    for (const LitMesh::Corner& c : lit.corners) positions.push_back(c.position);
    return plainMesh(positions, lit.indices);
}

/// The direction that a facet reflects into; the middle one for no roughness. `n`: the surface's normal.
glm::dvec3 reflectedAt(const glm::dvec3& n, double roughness, const glm::dvec3& in, Random& random) {
    const glm::dvec3 middle = in - 2 * glm::dot(n, in) * n;
    const double facing = -glm::dot(in, n);
    if (roughness <= 0 || facing <= 0) return middle;
    const double deviation = roughness * roughness * std::sqrt(0.5);
    const glm::dvec3 u =
        glm::normalize(glm::cross(n, std::abs(n.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0)));
    const glm::dvec3 v = glm::cross(n, u);
    for (int attempt = 0; attempt < 32; ++attempt) {
        const double radius = deviation * std::sqrt(-2 * std::log(1 - random.unit()));
        const double angle = 6.283185307179586 * random.unit();
        const glm::dvec3 facet = n - radius * (std::cos(angle) * u + std::sin(angle) * v);
        // How much of the facet the eye sees, against the mean surface; cut at twice.
        const double seen = -glm::dot(in, facet) / facing;
        if (random.unit() * 2 >= seen) continue;
        const glm::dvec3 m = glm::normalize(facet);
        const glm::dvec3 out = in - 2 * glm::dot(in, m) * m;
        if (glm::dot(out, n) > 0) return out;
    }
    return middle;
}

/// Where a wave throws what falls on it; as a smooth mirror would, where that is into the water.
glm::dvec3 reflectedByRipples(const MirrorWorld::Flat& mirror, const glm::dvec3& at, const glm::dvec3& in) {
    const glm::dvec3& n = mirror.mirror.plane.normal();
    const RippleFrame frame(n);
    const glm::dvec2 slope = rippleSlope(mirror.ripples, frame, at);
    const glm::dvec3 m = glm::normalize(n - slope.x * frame.u - slope.y * frame.v);
    const glm::dvec3 out = in - 2 * glm::dot(in, m) * m;
    return glm::dot(out, n) > 1e-3 ? out : mirror.mirror.plane.mirroredDirection(in);
}

}  // namespace

struct MirrorTruth::Impl {
    explicit Impl(const MirrorWorld& w) : world(w), scene(meshes) {
        std::vector<city::Mesh> plain;
        for (const LitMesh& m : world.objects) plain.push_back(plainMesh(m));
        for (const MirrorWorld::Flat& f : world.mirrors) {
            std::vector<glm::vec3> positions;
            std::vector<std::uint32_t> indices;
            for (const glm::dvec3& c : f.mirror.plane.corners()) positions.emplace_back(c);
            for (std::uint32_t i = 2; i < positions.size(); ++i) indices.insert(indices.end(), {0, i - 1, i});
            plain.push_back(plainMesh(positions, indices));
        }
        for (const MirrorWorld::Curved& c : world.curved) plain.push_back(plainMesh(c.finest()));
        std::vector<reflection::TracedMeshes::Part> parts;
        parts.reserve(plain.size());
        for (const city::Mesh& m : plain) parts.push_back({&m, false, nullptr});
        scene.place(meshes.add(parts), glm::mat4(1));
        scene.commit();
    }

    struct Path {
        glm::dvec3 origin, direction;
        glm::vec3 throughput{1}, light{0};
        std::uint32_t pixel = 0;
        std::uint8_t level = 0, curved = 0;
        bool rough = false;
        double fading = 0;  ///< 1 / metre: of all mirrors met that fade what they show
        Random random{0};
    };

    static glm::vec3 interpolated(const LitMesh& m, const TracedHit& hit, glm::vec3 LitMesh::Corner::*what) {
        const std::size_t i = std::size_t{3} * hit.triangle;
        return (1 - hit.u - hit.v) * (m.corners[m.indices[i]].*what) +
               hit.u * (m.corners[m.indices[i + 1]].*what) + hit.v * (m.corners[m.indices[i + 2]].*what);
    }

    /// Follows all paths to their ends.
    void follow(std::vector<Path>& paths, int depth) const {
        std::vector<std::size_t> going(paths.size());
        for (std::size_t i = 0; i < going.size(); ++i) going[i] = i;
        std::vector<TracedRay> rays;
        std::vector<TracedHit> hits;
        while (!going.empty()) {
            rays.clear();
            for (std::size_t i : going) {
                TracedRay ray;
                ray.origin = glm::vec3(paths[i].origin);
                ray.direction = glm::vec3(paths[i].direction);
                // A mirror's own surface lies at t = 0, good to some roundings of the coordinates.
                ray.from = paths[i].level > 0 ? 1e-5f : 0.f;
                rays.push_back(ray);
            }
            hits.assign(rays.size(), {});
            scene.trace(rays, hits, reflection::TracedScene::Backs::pass);
            std::vector<std::size_t> next;
            for (std::size_t k = 0; k < going.size(); ++k)
                if (bounce(paths[going[k]], hits[k], depth)) next.push_back(going[k]);
            going.swap(next);
        }
    }

    bool bounce(Path& path, const TracedHit& hit, int depth) const {
        if (path.fading > 0)
            path.throughput *=
                static_cast<float>(hit.found() ? std::exp(-path.fading * static_cast<double>(hit.t)) : 0);
        if (!hit.found()) {
            path.light += path.throughput * world.sky(glm::vec3(path.direction));
            return false;
        }
        const auto flats = static_cast<std::uint32_t>(world.objects.size());
        const auto balls = flats + static_cast<std::uint32_t>(world.mirrors.size());
        if (hit.part < flats) {
            path.light +=
                path.throughput * interpolated(world.objects[hit.part], hit, &LitMesh::Corner::colour);
            return false;
        }
        const bool flat = hit.part < balls;
        const glm::vec3 tint =
            flat ? world.mirrors[hit.part - flats].tint : world.curved[hit.part - balls].tint;
        const glm::vec3 share = flat ? world.mirrors[hit.part - flats].mirror.plane.surface().reflectance
                                     : world.curved[hit.part - balls].reflector.surface.reflectance;
        path.light += path.throughput * tint * (1.f - share);
        path.throughput *= share;
        if (path.level >= depth) {
            path.light += path.throughput * world.beyond;
            return false;
        }
        ++path.level;
        path.origin += static_cast<double>(hit.t) * path.direction;
        if (flat) {
            const reflection::MirrorPlane& plane = world.mirrors[hit.part - flats].mirror.plane;
            path.origin -= plane.signedDistance(path.origin) * plane.normal();
            path.rough = path.rough || plane.surface().roughness > 0;
            const MirrorWorld::Flat& mirror = world.mirrors[hit.part - flats];
            if (mirror.fade > 0) path.fading += 1 / mirror.fade;
            path.direction = mirror.ripples.any()
                                 ? reflectedByRipples(mirror, path.origin, path.direction)
                                 : reflectedAt(plane.normal(), static_cast<double>(plane.surface().roughness),
                                               path.direction, path.random);
        } else {
            path.curved = 1;
            const glm::dvec3 n = glm::normalize(
                interpolated(world.curved[hit.part - balls].finest(), hit, &LitMesh::Corner::normal));
            const auto roughness =
                static_cast<double>(world.curved[hit.part - balls].reflector.surface.roughness);
            path.rough = path.rough || roughness > 0;
            path.direction = glm::normalize(reflectedAt(n, roughness, path.direction, path.random));
        }
        return true;
    }

    const MirrorWorld& world;
    reflection::TracedMeshes meshes;
    reflection::TracedScene scene;
};

MirrorTruth::MirrorTruth(const MirrorWorld& world) : impl_(std::make_unique<Impl>(world)) {}
MirrorTruth::~MirrorTruth() = default;

TracedPicture MirrorTruth::picture(const reflection::TreeView& view,
                                   const MirrorTruthOptions& options) const {
    TracedPicture picture;
    picture.size = view.size;
    const auto width = static_cast<std::size_t>(view.size.x), height = static_cast<std::size_t>(view.size.y);
    picture.radiance.resize(width * height);
    picture.level.resize(width * height);
    picture.curved.resize(width * height);
    const glm::dmat3 worldFromView = glm::transpose(view.view.viewFromWorld);
    const glm::dmat4& c = view.view.clipFromView;
    tbb::parallel_for(std::size_t{0}, height, [&](std::size_t y) {
        const auto start = [&](std::size_t x, std::uint32_t sample) {
            Impl::Path path;
            const double u = (static_cast<double>(x) + 0.5) / static_cast<double>(width) * 2 - 1;
            const double v = 1 - (static_cast<double>(y) + 0.5) / static_cast<double>(height) * 2;
            path.origin = view.view.eye;
            path.direction = glm::normalize(worldFromView *
                                            glm::dvec3((u + c[2][0]) / c[0][0], (v + c[2][1]) / c[1][1], -1));
            path.pixel = static_cast<std::uint32_t>(x);
            path.random.state = options.seed * 0xd1342543de82ef95ULL +
                                (y * width + x) * 0x2545f4914f6cdd1dULL +
                                sample * 0x9e3779b97f4a7c15ULL * 1024;
            path.random.unit();
            return path;
        };
        std::vector<Impl::Path> paths;
        for (std::size_t x = 0; x < width; ++x) paths.push_back(start(x, 0));
        impl_->follow(paths, options.depth);
        std::vector<std::size_t> rough;
        for (std::size_t x = 0; x < width; ++x) {
            picture.radiance[y * width + x] = paths[x].light;
            picture.level[y * width + x] = paths[x].level;
            picture.curved[y * width + x] = paths[x].curved;
            if (paths[x].rough && options.samples > 1) rough.push_back(x);
        }
        if (rough.empty()) return;
        std::vector<glm::dvec3> sum(width, glm::dvec3(0));
        for (std::uint32_t s = 0; s < options.samples; ++s) {
            paths.clear();
            for (std::size_t x : rough) paths.push_back(start(x, s));
            impl_->follow(paths, options.depth);
            for (const Impl::Path& p : paths) sum[p.pixel] += glm::dvec3(p.light);
        }
        for (std::size_t x : rough)
            picture.radiance[y * width + x] = glm::vec3(sum[x] / static_cast<double>(options.samples));
    });
    return picture;
}

}  // namespace app
