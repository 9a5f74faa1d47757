#include "reflection/local_map/LocalMapMesh.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "reflection/reference_maps/CubeMapping.h"

namespace reflection {

namespace {

/// Marks a lattice point not traced yet; no ray gives a negative reciprocal.
constexpr float unknown = -1;
constexpr float requested = -2;
/// More would overflow a quad's coordinates and fill 128 MB.
constexpr int greatestLattice = 4096;

bool depthsDiffer(const std::array<float, 4>& w, float ratio) {
    // Z is the reciprocal of w, so max Z / min Z - 1 = max w / min w - 1.
    const auto [least, most] = std::minmax_element(w.begin(), w.end());
    if (*least == 0) return *most > 0;
    return *most - *least > ratio * *least;
}

bool isPlanar(const std::array<float, 4>& w, float centre, float tolerance) {
    const float scale = std::max(std::max(w[0], w[1]), std::max(w[2], w[3]));
    const float bound = tolerance * std::max(scale, centre);
    return std::abs(w[0] + w[3] - w[1] - w[2]) <= bound &&
           std::abs(0.25f * (w[0] + w[1] + w[2] + w[3]) - centre) <= bound;
}

}  // namespace

void LocalMapMesh::request(std::uint32_t node, float u, float v) {
    if (nodes_[node] != unknown) return;
    nodes_[node] = requested;
    wanted_.push_back(node);
    wantedAt_.emplace_back(u, v);
}

void LocalMapMesh::traceRequested(const GridTracer& tracer, const glm::vec3& centre, int face) {
    const std::size_t count = wanted_.size();
    if (count == 0) return;
    dx_.resize(count);
    dy_.resize(count);
    dz_.resize(count);
    t_.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
        const glm::vec3 d = cubeDirection(face, wantedAt_[i], lattice_);
        dx_[i] = d.x;
        dy_[i] = d.y;
        dz_[i] = d.z;
    }
    tracer.traceFan(centre, dx_, dy_, dz_, t_);
    // A reciprocal of a hit at the centre itself would be infinite; nothing in a street is nearer than a
    // millimetre.
    constexpr float nearest = 1e-3f;
    for (std::size_t i = 0; i < count; ++i)
        nodes_[wanted_[i]] = t_[i] >= nearest ? 1.0f / t_[i] : 1.0f / nearest;
    rays_ += static_cast<std::uint32_t>(count);
    known_.insert(known_.end(), wanted_.begin(), wanted_.end());
    wanted_.clear();
    wantedAt_.clear();
}

void LocalMapMesh::build(const GridTracer& tracer, const glm::vec3& centre, int face,
                         const MeshOptions& options) {
    const int depth = std::clamp(options.depth, 0, 8);
    const int base = std::clamp(options.baseCells, 1, greatestLattice >> depth);
    lattice_ = base << depth;
    greatest_ = 1 << depth;
    rays_ = 0;
    quads_.clear();
    const auto side = static_cast<std::uint32_t>(lattice_ + 1);
    const std::uint32_t centres = side * side;
    const std::size_t nodes =
        centres + static_cast<std::size_t>(lattice_) * static_cast<std::size_t>(lattice_);
    if (nodes_.size() == nodes)
        for (std::uint32_t node : known_) nodes_[node] = unknown;
    else
        nodes_.assign(nodes, unknown);
    known_.clear();

    const bool planarity = options.criterion == RefineCriterion::planarity;
    const auto node = [side](int x, int y) {
        return static_cast<std::uint32_t>(y) * side + static_cast<std::uint32_t>(x);
    };
    const auto middle = [&](int x, int y, int size) {
        return size == 1 ? centres + static_cast<std::uint32_t>(y * lattice_ + x)
                         : node(x + size / 2, y + size / 2);
    };

    active_.clear();
    for (int y = 0; y < base; ++y)
        for (int x = 0; x < base; ++x)
            active_.push_back(
                {static_cast<std::uint16_t>(x << depth), static_cast<std::uint16_t>(y << depth)});

    for (int size = 1 << depth; !active_.empty(); size /= 2) {
        for (const Cell& c : active_) {
            for (int k = 0; k < 4; ++k) {
                const int x = c.x + (k & 1) * size, y = c.y + (k >> 1) * size;
                request(node(x, y), static_cast<float>(x), static_cast<float>(y));
            }
            if (planarity) {
                const float half = 0.5f * static_cast<float>(size);
                request(middle(c.x, c.y, size), static_cast<float>(c.x) + half,
                        static_cast<float>(c.y) + half);
            }
        }
        traceRequested(tracer, centre, face);

        next_.clear();
        for (const Cell& c : active_) {
            std::array<float, 4> w;
            for (int k = 0; k < 4; ++k)
                w[static_cast<std::size_t>(k)] = nodes_[node(c.x + (k & 1) * size, c.y + (k >> 1) * size)];
            const float mid =
                planarity ? nodes_[middle(c.x, c.y, size)] : 0.25f * (w[0] + w[1] + w[2] + w[3]);
            const bool smooth =
                planarity ? isPlanar(w, mid, options.threshold) : !depthsDiffer(w, options.threshold);
            if (!smooth && size > 1) {
                const int half = size / 2;
                for (int k = 0; k < 4; ++k)
                    next_.push_back({static_cast<std::uint16_t>(c.x + (k & 1) * half),
                                     static_cast<std::uint16_t>(c.y + (k >> 1) * half)});
                continue;
            }
            quads_.push_back({c.x,
                              c.y,
                              static_cast<std::uint16_t>(size),
                              smooth || !planarity,
                              {w[0], w[1], w[2], w[3]},
                              mid});
        }
        active_.swap(next_);
        if (size == 1) break;
    }
}

}  // namespace reflection
