#include "reflection/chrome/CloseReflector.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

namespace reflection {

namespace {

/// Least cosine between a normal and the line to the centre. A map's cells are stretched by its reciprocal
/// where they lie on the surface, and so are its errors.
constexpr double leastCosine = 0.05;

/// Turns a normal in the plane that it spans with the direction until it keeps the least cosine.
bool liftNormal(glm::dvec3& normal, const glm::dvec3& outward) {
    const double along = glm::dot(normal, outward);
    if (along >= leastCosine) return false;
    glm::dvec3 across = normal - along * outward;
    const double length = glm::length(across);
    across = length > 0 ? across / length : glm::dvec3(0);
    normal = glm::normalize(std::sqrt(1 - leastCosine * leastCosine) * across + leastCosine * outward);
    return true;
}

/// What the tangent plane of a corner predicts for the reciprocal at another direction.
double planeAt(const ReflectorCorner& corner, const glm::dvec3& own, const glm::dvec3& g) {
    return corner.reciprocal * glm::dot(corner.normal, g) / glm::dot(corner.normal, own);
}

/// Slope and bend of the part go on by one cell: from a covered corner and the one behind it in the same
/// line.
bool continueRim(const CubeLattice& lattice, const std::vector<ReflectorCorner>& corners, std::uint32_t id,
                 ReflectorCorner& to) {
    glm::dvec3 normal(0);
    double reciprocal = 0;
    int n = 0;
    const glm::dvec3& g = lattice.point(id);
    for (std::size_t step = 0; step < 6; ++step) {
        const std::uint32_t near = lattice.neighbours(id)[step];
        if (near == CubeLattice::none || !corners[near].covered) continue;
        const ReflectorCorner& a = corners[near];
        const double plane = planeAt(a, lattice.point(near), g);
        const std::uint32_t far = lattice.neighbours(near)[step];
        if (far != CubeLattice::none && corners[far].covered) {
            const ReflectorCorner& b = corners[far];
            normal += 2.0 * a.normal - b.normal;
            // The plane misses half the second difference, the straight line all of it.
            reciprocal += 2 * plane - (2 * a.reciprocal - b.reciprocal);
        } else {
            normal += a.normal;
            reciprocal += plane;
        }
        ++n;
    }
    if (n == 0) return false;
    to.normal = glm::normalize(normal);
    to.reciprocal = reciprocal / n;
    return true;
}

/// Tangent planes along the rim of which the envelope is taken, at most.
constexpr std::size_t mostPlanes = 192;
/// Radius of the envelope's ball, in radii of the part: it closes the far side, and must not touch the part.
constexpr double ballRadius = 1.5;
/// Times that creases of the envelope are averaged over their neighbours.
constexpr int roundings = 4;

/// Everything that no layer has reached yet. A plane c . x = 1 is kept as c: along g it lies at 1 / (c . g),
/// and the nearest of all planes bounds the body.
void closeByEnvelope(const CubeLattice& lattice, std::vector<ReflectorCorner>& corners,
                     const std::vector<std::uint32_t>& layer, const std::vector<std::uint32_t>& rim) {
    double radius = 0;
    for (std::uint32_t id = 0; id < lattice.size(); ++id)
        if (layer[id] > 0) radius = std::max(radius, glm::length(lattice.point(id)) / corners[id].reciprocal);
    radius *= ballRadius;
    std::vector<glm::dvec3> planes;
    const std::size_t step = rim.size() / mostPlanes + 1;
    for (std::size_t k = 0; k < rim.size(); k += step) {
        const ReflectorCorner& c = corners[rim[k]];
        planes.push_back(c.normal * (c.reciprocal / glm::dot(c.normal, lattice.point(rim[k]))));
    }
    struct Open {
        std::uint32_t id;
        double q;
        glm::dvec3 plane;
    };
    constexpr std::uint32_t none = ~std::uint32_t{0};
    std::vector<Open> open;
    std::vector<std::uint32_t> place(lattice.size(), none);
    for (std::uint32_t id = 0; id < lattice.size(); ++id) {
        if (layer[id] > 0) continue;
        const glm::dvec3& g = lattice.point(id);
        const double length = glm::length(g);
        Open o{id, length / radius, g / (length * radius)};
        for (const glm::dvec3& c : planes) {
            const double q = glm::dot(c, g);
            if (q > o.q) o.q = q, o.plane = c;
        }
        place[id] = static_cast<std::uint32_t>(open.size());
        open.push_back(o);
    }
    // On a face the reciprocal distance of a convex body is a convex function, and so is its average.
    std::vector<Open> rounded = open;
    for (int k = 0; k < roundings; ++k) {
        for (std::size_t o = 0; o < open.size(); ++o) {
            const glm::dvec3& g = lattice.point(open[o].id);
            const glm::dvec3 major(glm::greaterThan(glm::abs(g), glm::dvec3(1 - 1e-9)));
            // On edges of the cube faces bend.
            if (major.x + major.y + major.z > 1.5) continue;
            double q = 2 * open[o].q;
            glm::dvec3 plane = 2.0 * open[o].plane;
            double n = 2;
            for (const std::uint32_t near : lattice.neighbours(open[o].id)) {
                if (near == CubeLattice::none || place[near] == none) continue;
                q += open[place[near]].q;
                plane += open[place[near]].plane;
                n += 1;
            }
            if (n < 5.5) continue;
            rounded[o].q = q / n;
            plane /= n;
            // Slopes are averaged along the face; the rest follows from the value.
            const glm::dvec3 axis = major * g;
            rounded[o].plane = plane + (q / n - glm::dot(plane, g)) * axis;
        }
        open.swap(rounded);
    }
    for (const Open& o : open) {
        const glm::dvec3& g = lattice.point(o.id);
        ReflectorCorner& c = corners[o.id];
        c.normal = glm::normalize(o.plane);
        c.reciprocal = o.q;
        liftNormal(c.normal, g / glm::length(g));
    }
}

}  // namespace

ClosedReflector closeReflector(const CubeLattice& lattice, std::vector<ReflectorCorner>& corners, double sign,
                               Closing closing, int cells) {
    ClosedReflector result;
    double radius = 0;
    std::vector<std::uint32_t> layer(lattice.size(), 0);  // 0: not reached yet; covered corners are layer 1
    for (std::uint32_t id = 0; id < lattice.size(); ++id) {
        ReflectorCorner& c = corners[id];
        if (!c.covered) continue;
        const glm::dvec3& g = lattice.point(id);
        const double length = glm::length(g);
        if (liftNormal(c.normal, (sign / length) * g)) ++result.tilted;
        radius += length / c.reciprocal;
        layer[id] = 1;
        ++result.covered;
    }
    if (result.covered == 0) return result;
    radius /= static_cast<double>(result.covered);

    std::vector<std::uint32_t> front;
    std::vector<ReflectorCorner> made;
    const auto touches = [&](std::uint32_t id) {
        return std::any_of(lattice.neighbours(id).begin(), lattice.neighbours(id).end(),
                           [&](std::uint32_t n) { return n != CubeLattice::none && layer[n] > 0; });
    };
    const double blendLayers = std::max(1.0, 0.25 * cells);
    for (std::uint32_t depth = 2;; ++depth) {
        front.clear();
        made.clear();
        for (std::uint32_t id = 0; id < lattice.size(); ++id)
            if (layer[id] == 0 && touches(id)) front.push_back(id);
        if (front.empty()) break;
        for (const std::uint32_t id : front) {
            const glm::dvec3& g = lattice.point(id);
            const double length = glm::length(g);
            const glm::dvec3 outward = (sign / length) * g;
            ReflectorCorner c;
            if (depth > 2 || !continueRim(lattice, corners, id, c)) {
                int n = 0;
                for (const std::uint32_t near : lattice.neighbours(id)) {
                    if (near == CubeLattice::none || layer[near] == 0) continue;
                    c.normal += corners[near].normal;
                    c.reciprocal += std::max(planeAt(corners[near], lattice.point(near), g), 0.0);
                    ++n;
                }
                c.reciprocal /= n;
            }
            const double blend = std::clamp((depth - 2) / blendLayers, 0.0, 1.0);
            c.normal = glm::normalize((1 - blend) * c.normal + blend * outward);
            c.reciprocal = (1 - blend) * c.reciprocal + blend * length / radius;
            // No farther out than four radii: a plane that runs on would reach infinity.
            c.reciprocal = std::max(c.reciprocal, 0.25 * length / radius);
            liftNormal(c.normal, outward);
            made.push_back(c);
        }
        for (std::size_t k = 0; k < front.size(); ++k) {
            corners[front[k]] = made[k];
            layer[front[k]] = depth;
        }
        if (closing == Closing::envelope) {
            closeByEnvelope(lattice, corners, layer, front);
            break;
        }
    }
    return result;
}

}  // namespace reflection
