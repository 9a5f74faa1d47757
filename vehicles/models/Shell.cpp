#include "vehicles/models/Shell.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <unordered_map>

namespace vehicles {
namespace {

std::uint64_t edgeKey(std::uint32_t a, std::uint32_t b) {
    return a < b ? (std::uint64_t{a} << 32 | b) : (std::uint64_t{b} << 32 | a);
}

std::uint32_t addBetween(Shell& shell, std::uint32_t a, std::uint32_t b, float t) {
    const glm::vec3 p = shell.positions[a] + t * (shell.positions[b] - shell.positions[a]);
    const glm::vec3 n = shell.normals[a] + t * (shell.normals[b] - shell.normals[a]);
    const float length = glm::length(n);
    shell.positions.push_back(p);
    shell.normals.push_back(length > 1e-6f ? n / length : shell.normals[a]);
    return static_cast<std::uint32_t>(shell.positions.size() - 1);
}

bool listed(const std::vector<Surface>& list, Surface s) {
    return list.empty() || std::find(list.begin(), list.end(), s) != list.end();
}

/// Where the field vanishes between two ends of unlike sign: false position with bisection (Illinois), 12
/// rounds bring an edge of 10 cm well below a tenth of a millimetre.
float rootBetween(const Shell& shell, const Field& field, std::uint32_t a, std::uint32_t b, float fa,
                  float fb) {
    float lo = 0, hi = 1, t = 0.5f;
    for (int round = 0; round < 12; ++round) {
        t = lo + (hi - lo) * fa / (fa - fb);
        const glm::vec3 p = shell.positions[a] + t * (shell.positions[b] - shell.positions[a]);
        const glm::vec3 n = shell.normals[a] + t * (shell.normals[b] - shell.normals[a]);
        const float f = field(p, n);
        if (std::abs(f) < 1e-5f) break;
        if ((f < 0) == (fa < 0)) {
            lo = t;
            fa = f;
            fb *= 0.5f;
        } else {
            hi = t;
            fb = f;
            fa *= 0.5f;
        }
    }
    return t;
}

}  // namespace

void Shell::refine(const Field& field, float longest) {
    // Cutting straight across an edge misses the line by about this much at most.
    constexpr float tolerance = 0.0015f;
    std::vector<float> value;
    for (int round = 0; round < 6; ++round) {
        std::unordered_map<std::uint64_t, std::uint32_t> middle;
        for (std::size_t i = value.size(); i < positions.size(); ++i)
            value.push_back(field(positions[i], normals[i]));
        std::vector<bool> touched(positions.size(), false);
        const auto split = [&](std::uint32_t a, std::uint32_t b) {
            const glm::vec3 along = positions[b] - positions[a];
            const float length = glm::length(along);
            if (length <= longest) return;
            // A distance field changes by no more than the way gone: farther ends than that cannot meet the
            // line.
            if (std::min(std::abs(value[a]), std::abs(value[b])) > 0.75f * length) return;
            const glm::vec3 p = positions[a] + 0.5f * along;
            const float bend = field(p, 0.5f * (normals[a] + normals[b])) - 0.5f * (value[a] + value[b]);
            if (std::abs(bend) < tolerance || (touched[a] && touched[b] && middle.contains(edgeKey(a, b))))
                return;
            middle[edgeKey(a, b)] = addBetween(*this, a, b, 0.5f);
            touched[a] = touched[b] = true;
        };
        for (const Triangle& t : triangles)
            for (int k = 0; k < 3; ++k) split(t.corner[k], t.corner[(k + 1) % 3]);
        if (middle.empty()) return;
        std::vector<Triangle> out;
        out.reserve(triangles.size() * 2);
        for (const Triangle& t : triangles) {
            constexpr auto none = ~std::uint32_t{0};
            std::uint32_t m[3];
            int count = 0;
            for (int k = 0; k < 3; ++k) {
                const auto a = t.corner[k], b = t.corner[(k + 1) % 3];
                m[k] = none;
                if (!touched[a] || !touched[b]) continue;
                if (const auto found = middle.find(edgeKey(a, b)); found != middle.end())
                    m[k] = found->second;
                count += m[k] != none;
            }
            const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
                out.push_back({{a, b, c}, t.surface});
            };
            if (count == 0) {
                out.push_back(t);
            } else if (count == 3) {
                add(t.corner[0], m[0], m[2]);
                add(m[0], t.corner[1], m[1]);
                add(m[2], m[1], t.corner[2]);
                add(m[0], m[1], m[2]);
            } else {
                // Turn the triangle so that edge 0 is split and, with two, edge 1 as well.
                int k = 0;
                while (m[k] == none || (count == 2 && m[(k + 1) % 3] == none)) ++k;
                const auto a = t.corner[k], b = t.corner[(k + 1) % 3], c = t.corner[(k + 2) % 3];
                if (count == 1) {
                    add(a, m[k], c);
                    add(m[k], b, c);
                } else {
                    const auto n = m[(k + 1) % 3];
                    add(m[k], b, n);
                    add(a, m[k], n);
                    add(a, n, c);
                }
            }
        }
        triangles = std::move(out);
    }
}

void Shell::divide(const Field& field) {
    std::vector<float> value(positions.size());
    for (std::size_t i = 0; i < positions.size(); ++i) value[i] = field(positions[i], normals[i]);
    std::unordered_map<std::uint64_t, std::uint32_t> cut;
    // A vertex this near to the line, as a share of the edge, counts as on it: slivers would help nobody.
    constexpr float snap = 0.03f;
    for (const Triangle& t : triangles)
        for (int k = 0; k < 3; ++k) {
            const auto a = t.corner[k], b = t.corner[(k + 1) % 3];
            const float fa = value[a], fb = value[b];
            if (fa * fb >= 0) continue;
            if (std::abs(fa) < snap * std::abs(fa - fb)) value[a] = 0;
            if (std::abs(fb) < snap * std::abs(fa - fb)) value[b] = 0;
        }
    const auto cutAt = [&](std::uint32_t a, std::uint32_t b) {
        if (a > b) std::swap(a, b);
        const auto key = edgeKey(a, b);
        if (const auto found = cut.find(key); found != cut.end()) return found->second;
        const auto made = addBetween(*this, a, b, rootBetween(*this, field, a, b, value[a], value[b]));
        value.push_back(0);
        return cut[key] = made;
    };
    std::vector<Triangle> out;
    out.reserve(triangles.size() + triangles.size() / 4);
    for (const Triangle& t : triangles) {
        int negative = 0, positive = 0;
        for (const auto c : t.corner) {
            negative += value[c] < 0;
            positive += value[c] > 0;
        }
        if (negative == 0 || positive == 0) {
            out.push_back(t);
            continue;
        }
        const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
            out.push_back({{a, b, c}, t.surface});
        };
        int k = 0;
        if (negative + positive == 2) {  // the line goes through a corner
            while (value[t.corner[k]] != 0) ++k;
            const auto a = t.corner[k], b = t.corner[(k + 1) % 3], c = t.corner[(k + 2) % 3];
            const auto m = cutAt(b, c);
            add(a, b, m);
            add(a, m, c);
            continue;
        }
        const bool loneNegative = negative == 1;
        while ((value[t.corner[k]] < 0) != loneNegative) ++k;
        const auto a = t.corner[k], b = t.corner[(k + 1) % 3], c = t.corner[(k + 2) % 3];
        const auto ab = cutAt(a, b), ca = cutAt(c, a);
        add(a, ab, ca);
        // The shorter diagonal of the remaining quadrilateral.
        const glm::vec3 d1 = positions[ab] - positions[c], d2 = positions[b] - positions[ca];
        if (glm::dot(d1, d1) < glm::dot(d2, d2)) {
            add(ab, b, c);
            add(ab, c, ca);
        } else {
            add(ab, b, ca);
            add(b, c, ca);
        }
    }
    triangles = std::move(out);
}

namespace {
float atMiddle(const Shell& shell, const Shell::Triangle& t, const Field& field) {
    glm::vec3 p{0}, n{0};
    for (const auto c : t.corner) {
        p += shell.positions[c] / 3.0f;
        n += shell.normals[c] / 3.0f;
    }
    return field(p, n);
}
}  // namespace

void Shell::assign(const Field& field, Surface surface, const std::vector<Surface>& over) {
    divide(field);
    for (Triangle& t : triangles)
        if (listed(over, t.surface) && atMiddle(*this, t, field) < 0) t.surface = surface;
}

void Shell::assignLine(const Field& field, float halfWidth, Surface surface,
                       const std::vector<Surface>& over) {
    divide([&](const glm::vec3& p, const glm::vec3& n) { return field(p, n) - halfWidth; });
    divide([&](const glm::vec3& p, const glm::vec3& n) { return field(p, n) + halfWidth; });
    for (Triangle& t : triangles)
        if (listed(over, t.surface) && std::abs(atMiddle(*this, t, field)) < halfWidth) t.surface = surface;
}

void Shell::remove(const Field& field) {
    divide(field);
    std::erase_if(triangles, [&](const Triangle& t) { return atMiddle(*this, t, field) < 0; });
}

void Shell::recess(const Field& field, float depth) {
    for (std::size_t i = 0; i < positions.size(); ++i)
        if (field(positions[i], normals[i]) < 0) positions[i] -= depth * normals[i];
}

void Shell::mirror(float seam) {
    const std::size_t count = positions.size(), faces = triangles.size();
    std::vector<std::uint32_t> image(count);
    for (std::size_t i = 0; i < count; ++i) {
        if (std::abs(positions[i].y) < seam) {
            positions[i].y = 0;
            normals[i].y = 0;
            normals[i] = glm::normalize(normals[i]);
            image[i] = static_cast<std::uint32_t>(i);
        } else {
            image[i] = static_cast<std::uint32_t>(positions.size());
            const glm::vec3 p = positions[i], n = normals[i];
            positions.push_back({p.x, -p.y, p.z});
            normals.push_back({n.x, -n.y, n.z});
        }
    }
    for (std::size_t i = 0; i < faces; ++i) {
        const Triangle t = triangles[i];
        triangles.push_back({{image[t.corner[0]], image[t.corner[2]], image[t.corner[1]]}, t.surface});
    }
}

namespace {

/// The mesh of a shell, and for each of its vertices the shell's.
city::Mesh meshOf(const Shell& shell, std::vector<std::uint32_t>& origin) {
    city::Mesh out;
    std::unordered_map<std::uint64_t, std::uint32_t> made;
    for (const Shell::Triangle& t : shell.triangles) {
        if (t.corner[0] == t.corner[1] || t.corner[1] == t.corner[2] || t.corner[2] == t.corner[0]) continue;
        for (const auto c : t.corner) {
            const auto surface = static_cast<std::uint32_t>(t.surface);
            const auto [place, fresh] = made.try_emplace(std::uint64_t{c} << 8 | surface,
                                                         static_cast<std::uint32_t>(out.vertices.size()));
            if (fresh) {
                out.vertices.push_back({shell.positions[c], shell.normals[c], glm::vec2(0), surface});
                origin.push_back(c);
            }
            out.indices.push_back(place->second);
        }
    }
    return out;
}

}  // namespace

void Shell::simplify(std::size_t target, float error) {
    std::vector<std::uint32_t> origin;
    const city::Mesh full = meshOf(*this, origin);
    if (full.empty()) return;
    const float* coordinates = &full.vertices[0].position.x;
    const float scale = meshopt_simplifyScale(coordinates, full.vertices.size(), sizeof(city::Vertex));
    std::vector<std::uint32_t> kept(full.indices.size());
    kept.resize(meshopt_simplify(kept.data(), full.indices.data(), full.indices.size(), coordinates,
                                 full.vertices.size(), sizeof(city::Vertex), target * 3, error / scale,
                                 meshopt_SimplifyLockBorder, nullptr));
    triangles.clear();
    for (std::size_t i = 0; i < kept.size(); i += 3)
        triangles.push_back({{origin[kept[i]], origin[kept[i + 1]], origin[kept[i + 2]]},
                             static_cast<Surface>(full.vertices[kept[i]].material)});
}

city::Mesh Shell::mesh() const {
    std::vector<std::uint32_t> origin;
    return meshOf(*this, origin);
}

}  // namespace vehicles
