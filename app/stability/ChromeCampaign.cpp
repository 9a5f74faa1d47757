// Close chrome: reflectors of a millimetre and of a kilometre, eyes and vertices on them, in them and at
// infinity, parts that are flat, creased, pointed, torn or no surface at all.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include <glm/geometric.hpp>

#include "app/stability/SeededRandom.h"
#include "app/stability/Stability.h"
#include "reflection/chrome/ChromeTree.h"
#include "reflection/chrome/ReflectionSearch.h"
#include "reflection/chrome/ReflectorPieces.h"
#include "reflection/chrome/VirtualMesh.h"

namespace app::stability {

namespace {

using namespace reflection;

glm::dvec3 direction(SeededRandom& random) {
    const double z = random.between(-1, 1), a = random.between(0, 6.283185307179586),
                 r = std::sqrt(1 - z * z);
    return {r * std::cos(a), r * std::sin(a), z};
}

void fail(Row& row, const std::string& what) {
    ++row.failures;
    if (row.example.empty()) row.example = what;
}

city::Vertex vertexAt(const glm::dvec3& p, const glm::dvec3& n) {
    city::Vertex v;
    v.position = glm::vec3(p);
    v.normal = glm::vec3(n);
    return v;
}

/// Rows and columns of a surface over two parameters in 0..1, with its normals by differences.
template <typename Surface>
city::Mesh sheet(std::uint32_t rows, std::uint32_t columns, const Surface& at) {
    city::Mesh mesh;
    for (std::uint32_t j = 0; j <= rows; ++j)
        for (std::uint32_t i = 0; i <= columns; ++i) {
            const double u = static_cast<double>(i) / columns, v = static_cast<double>(j) / rows;
            const glm::dvec3 n =
                glm::cross(at(u + 1e-4, v) - at(u - 1e-4, v), at(u, v + 1e-4) - at(u, v - 1e-4));
            const double length = glm::length(n);
            mesh.vertices.push_back(vertexAt(at(u, v), length > 0 ? n / length : glm::dvec3(0, 0, 1)));
        }
    for (std::uint32_t j = 0; j < rows; ++j)
        for (std::uint32_t i = 0; i < columns; ++i) {
            const std::uint32_t a = j * (columns + 1) + i, c = a + columns + 1;
            mesh.indices.insert(mesh.indices.end(), {a, a + 1, c + 1, a, c + 1, c});
        }
    return mesh;
}

glm::dvec3 onBall(double u, double v) {
    const double turn = 6.283185307179586 * u, polar = 3.141592653589793 * (1 - std::clamp(v, 0.0, 1.0));
    return {std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn), std::cos(polar)};
}

/// What every search must say.
struct Told {
    bool status = true, finite = true, residual = true;
    double worst = 0;

    void look(const ReflectionPoint& r, bool asked) {
        const bool known = r.status == ReflectionStatus::found || r.status == ReflectionStatus::hidden ||
                           r.status == ReflectionStatus::unreflected;
        status = status && (asked ? known : r.status == ReflectionStatus::invalid);
        finite = finite && std::isfinite(r.point.x + r.point.y + r.point.z + r.normal.x + r.normal.y +
                                         r.normal.z + r.residual + r.path);
        if (r.status != ReflectionStatus::found) return;
        worst = std::max(worst, r.residual);
        residual = residual && r.residual <= 1e-6;
    }
    bool good() const { return status && finite && residual; }
};

/// Eyes and vertices where a reflector of that size makes it hardest.
std::vector<glm::dvec3> hardPlaces(const city::Mesh& mesh, double size, SeededRandom& random) {
    std::vector<glm::dvec3> places{{0, 0, 0}, 1e6 * direction(random), 1e6 * size * direction(random)};
    for (int k = 0; k < 4; ++k) {
        const city::Vertex& v =
            mesh.vertices[static_cast<std::size_t>(random.below(static_cast<int>(mesh.vertices.size())))];
        const glm::dvec3 p(v.position), n(v.normal);
        for (const double height : {0.0, 1e-12, -1e-12, 1e-6, -1e-6, 1e-2, -0.3, 1.0})
            places.push_back(p + height * size * n);
    }
    for (int k = 0; k < 12; ++k) places.push_back(random.magnitude(1e-3, 1e3) * size * direction(random));
    return places;
}

void searchAll(const Reflector& reflector, const std::vector<glm::dvec3>& places, Row& row,
               const std::string& what) {
    std::vector<ReflectionPoint> points(places.size());
    for (std::size_t piece = 0; piece < std::min<std::size_t>(reflector.pieces.size(), 4); ++piece) {
        const ReflectorMap& map = reflector.pieces[piece].built.map;
        const std::size_t eyes = map.bend() == Bend::concave ? 2 : places.size();
        for (std::size_t e = 0; e < eyes; ++e) {
            findReflectionPoints(map, places[e * places.size() / eyes], places, points);
            row.tried += points.size();
            Told told;
            for (const ReflectionPoint& r : points) told.look(r, !map.empty());
            row.worst = std::max(row.worst, told.worst);
            if (!told.good())
                fail(row, what + ", piece " + std::to_string(piece) + ", eye " + std::to_string(e) +
                              (told.status ? "" : ": no status") + (told.finite ? "" : ": not finite") +
                              (told.residual ? "" : ": residual"));
        }
    }
}

constexpr const char* residualBound = "what the search promises of every vertex it reports found";

Row sizes(const Options& options, SeededRandom& random) {
    Row row{"chrome", "reflectors of 1e-3 to 1e3 m; eyes and vertices on, in, at the centre, at 1e6 m",
            0,        0,
            0,        1e-6,
            "rad",    residualBound,
            ""};
    for (int i = 0; i < 7 * options.effort() && !options.stop(); ++i) {
        const double size = std::pow(10.0, -3 + i % 7);
        const glm::dvec3 radii(size, size * random.between(0.2, 1), size * random.between(0.2, 1));
        const bool open = i % 2 == 1;
        const city::Mesh mesh =
            sheet(24, 48, [&](double u, double v) { return radii * onBall(u, open ? 0.5 + 0.5 * v : v); });
        const Reflector reflector = makeReflector(mesh, {.cellsPerSide = 24});
        if (reflector.pieces.empty()) fail(row, "no piece of size " + std::to_string(size));
        searchAll(reflector, hardPlaces(mesh, size, random), row, "body " + std::to_string(i));
    }
    return row;
}

/// Parts that are barely surfaces, or none.
city::Mesh oddPart(int kind, SeededRandom& random) {
    const auto flat = [](double u, double v) { return glm::dvec3(u - 0.5, v - 0.5, 0); };
    city::Mesh mesh;
    switch (kind) {
        case 0:
            return sheet(4, 4, flat);
        case 1:  // a crease
            return sheet(8, 8, [](double u, double v) { return glm::dvec3(u - 0.5, v, -std::abs(u - 0.5)); });
        case 2:  // a sharp one, seen from inside
            return sheet(8, 8,
                         [](double u, double v) { return glm::dvec3(u - 0.5, v, 4 * std::abs(u - 0.5)); });
        case 3:  // a cusp: a cone to its tip
            return sheet(12, 24, [](double u, double v) {
                const double a = 6.283185307179586 * u, r = std::max(1 - v, 0.0);
                return glm::dvec3(r * std::cos(a), r * std::sin(a), 3 * v * v);
            });
        case 4: {  // triangles without area among others
            mesh = sheet(6, 6, flat);
            for (int k = 0; k < 40; ++k) {
                const auto a = static_cast<std::uint32_t>(random.below(49));
                mesh.indices.insert(mesh.indices.end(), {a, a, static_cast<std::uint32_t>(random.below(49))});
            }
            return mesh;
        }
        case 5: {  // fins: edges of three and four triangles
            mesh = sheet(6, 6, flat);
            for (int k = 0; k < 24; ++k) {
                const auto a = static_cast<std::uint32_t>(random.below(48));
                mesh.vertices.push_back(vertexAt(direction(random), direction(random)));
                mesh.indices.insert(mesh.indices.end(),
                                    {a, a + 1, static_cast<std::uint32_t>(mesh.vertices.size() - 1)});
            }
            return mesh;
        }
        case 6: {  // the same surface twice, front to front
            mesh = sheet(6, 6, flat);
            city::Mesh back = mesh;
            for (std::size_t k = 0; k + 2 < back.indices.size(); k += 3)
                std::swap(back.indices[k], back.indices[k + 1]);
            mesh.append(back);
            return mesh;
        }
        case 7: {  // triangles anywhere
            for (std::uint32_t k = 0; k < 60; ++k) {
                mesh.vertices.push_back(vertexAt(direction(random) * random.magnitude(1e-3, 1e3),
                                                 random.oneIn(5) ? glm::dvec3(0) : direction(random)));
                mesh.indices.push_back(k);
            }
            return mesh;
        }
        case 8: {  // what is not a number
            mesh = sheet(6, 6, flat);
            const float nan = std::numeric_limits<float>::quiet_NaN(),
                        inf = std::numeric_limits<float>::infinity();
            for (int k = 0; k < 8; ++k) {
                city::Vertex& v = mesh.vertices[static_cast<std::size_t>(random.below(49))];
                (random.oneIn(2) ? v.position.x : v.normal.y) = random.oneIn(2) ? nan : inf;
            }
            return mesh;
        }
        case 9:  // a ring
            return sheet(24, 12, [](double u, double v) {
                const double a = 6.283185307179586 * v, b = 6.283185307179586 * u;
                const glm::dvec3 out(std::cos(a), std::sin(a), 0);
                return (1 + 0.3 * std::cos(b)) * out + glm::dvec3(0, 0, -0.3 * std::sin(b));
            });
        case 10:
            return sheet(8, 8, [](double u, double v) {  // a saddle
                return glm::dvec3(u - 0.5, v - 0.5, (u - 0.5) * (u - 0.5) - (v - 0.5) * (v - 0.5));
            });
        default:
            return {};
    }
}
constexpr int oddParts = 12;

Row parts(const Options& options, SeededRandom& random) {
    Row row{"chrome", "flat, creased, pointed, torn parts, soups and nothing",
            0,        0,
            0,        1e-6,
            "rad",    residualBound,
            ""};
    for (int i = 0; i < oddParts * options.effort() && !options.stop(); ++i) {
        const double size = random.magnitude(1e-3, 1e3);
        city::Mesh mesh = oddPart(i % oddParts, random);
        for (city::Vertex& v : mesh.vertices) v.position *= static_cast<float>(size);
        const Reflector reflector = makeReflector(mesh, {.cellsPerSide = 16});
        std::size_t kept = reflector.skipped;
        for (const ReflectorPiece& p : reflector.pieces) kept += p.mesh.indices.size() / 3;
        const std::string what = "part " + std::to_string(i);
        if (kept != mesh.indices.size() / 3) fail(row, what + ": triangles are lost or doubled");
        if (mesh.vertices.empty()) {
            ++row.tried;
            if (!reflector.pieces.empty()) fail(row, "something was made of nothing");
            continue;
        }
        city::Mesh finite = mesh;
        std::erase_if(finite.vertices, [](const city::Vertex& v) {
            return !std::isfinite(v.position.x + v.normal.y + v.normal.x + v.position.y);
        });
        searchAll(reflector, hardPlaces(finite, size, random), row, what);
    }
    return row;
}

/// A reflector and its surroundings at any scale give the same statuses and points.
Row scales(const Options& options, SeededRandom& random) {
    Row row{"chrome",
            "the same scene at 2^-10 to 2^10",
            0,
            0,
            0,
            1e-9,
            "of the radius",
            "powers of two change no digit of the mesh; searches are in the map's own frame",
            ""};
    const auto body = [](double size) {
        return sheet(24, 48,
                     [size](double u, double v) { return size * glm::dvec3(1, 0.5, 0.75) * onBall(u, v); });
    };
    const Reflector plain = makeReflector(body(1), {.cellsPerSide = 24});
    for (int i = 0; i < 6 * options.effort() && !options.stop(); ++i) {
        const double scale = std::ldexp(1.0, -10 + 4 * (i % 6));
        const Reflector scaled = makeReflector(body(scale), {.cellsPerSide = 24});
        if (scaled.pieces.size() != plain.pieces.size() || plain.pieces.empty()) {
            fail(row, "other pieces at " + std::to_string(scale));
            continue;
        }
        for (int k = 0; k < 200; ++k) {
            const glm::dvec3 eye = random.magnitude(1.5, 20) * direction(random),
                             v = random.magnitude(1.1, 20) * direction(random), eyeAt = scale * eye,
                             at = scale * v;
            ReflectionPoint a, b;
            findReflectionPoints(plain.pieces[0].built.map, eye, std::span(&v, 1), std::span(&a, 1));
            findReflectionPoints(scaled.pieces[0].built.map, eyeAt, std::span(&at, 1), std::span(&b, 1));
            ++row.tried;
            const double off = glm::length(b.point / scale - a.point);
            row.worst = std::max(row.worst, off);
            if (a.status != b.status || !(off <= row.bound)) fail(row, "scale " + std::to_string(scale));
        }
    }
    return row;
}

/// Whole meshes as virtual objects: nothing drawn that is not a number, no more vertices than halvings allow.
Row meshes(const Options& options, SeededRandom& random) {
    Row row{"chrome",
            "virtual meshes of odd parts in odd reflectors",
            0,
            0,
            0,
            0,
            "broken images",
            "every drawn vertex is finite, every index within the vertices",
            ""};
    for (int i = 0; i < oddParts * options.effort() && !options.stop(); ++i) {
        const Reflector reflector = makeReflector(oddPart(i % 4, random), {.cellsPerSide = 16});
        const city::Mesh mesh = oddPart(i % oddParts, random);
        std::vector<glm::vec3> positions;
        for (const city::Vertex& v : mesh.vertices) positions.push_back(v.position + glm::vec3(0, 0, 1));
        VirtualMeshOptions how;
        how.mostHalvings = 2;
        VirtualMesh image(positions, mesh.indices, how);
        for (std::size_t p = 0; p < std::min<std::size_t>(reflector.pieces.size(), 2); ++p) {
            const ReflectorMap& map = reflector.pieces[p].built.map;
            if (map.empty()) continue;
            image.update(map, 3.0 * direction(random), glm::dmat4(1), how);
            ++row.tried;
            bool good = true;
            for (const std::uint32_t k : image.indices())
                good = good && k < image.vertices().size() &&
                       std::isfinite(image.vertices()[k].fromEye.x + image.vertices()[k].fromEye.y +
                                     image.vertices()[k].fromEye.z);
            if (!good) fail(row, "image " + std::to_string(i));
        }
    }
    row.worst = static_cast<double>(row.failures);
    return row;
}

/// Chrome that sees chrome: balls of any size that touch, hold each other or share a place, looked at from
/// anywhere, the eye of a picture among it.
Row bounces(const Options& options, SeededRandom& random) {
    Row row{
        "chrome",
        "chrome in chrome: touching, one in the other, the same; eyes at a picture's eye, on, in, far off",
        0,
        0,
        0,
        0,
        "broken plans",
        "every node finite, its parent before it, no deeper and no more pictures than asked",
        ""};
    for (int i = 0; i < 4 * options.effort() && !options.stop(); ++i) {
        const double size = random.magnitude(1e-3, 1e3), other = size * random.magnitude(0.05, 20);
        const auto ball = [&](double radius) {
            return makeReflector(
                sheet(16, 32, [radius](double u, double v) { return radius * onBall(u, v); }),
                {.cellsPerSide = 16});
        };
        const Reflector a = ball(size), b = ball(other);
        const auto pointsOf = [](const Reflector& r) {
            std::vector<std::vector<SurfacePoint>> points;
            for (const ReflectorPiece& piece : r.pieces) points.push_back(spreadPoints(piece.mesh, 24));
            return points;
        };
        const auto ofA = pointsOf(a), ofB = pointsOf(b);
        for (const double apart : {0.0, std::abs(size - other), size + other, 1.5 * (size + other)}) {
            std::array<ChromeBody, 2> bodies;
            bodies[0] = {&a, ofA, glm::dmat4(1), glm::dvec3(0), size, 1e4 * (size + other), true};
            bodies[1] = {&b, ofB, glm::dmat4(1), glm::dvec3(0), other, 1e4 * (size + other), true};
            bodies[1].centre = apart * direction(random);
            bodies[1].worldFromPart[3] = glm::dvec4(bodies[1].centre, 1);
            ChromeTreeOptions how;
            how.depth = 1 + i % 8;
            how.mostPictures = 12;
            how.mostStray = 100;
            std::vector<glm::dvec3> eyes{glm::dvec3(0), size * direction(random), bodies[1].centre,
                                         1e6 * size * direction(random),
                                         3 * (size + other) * direction(random)};
            for (std::size_t e = 0; e < eyes.size() && e < 8; ++e) {
                const ChromeTree tree = chromeTree(
                    perspectiveView(eyes[e], bodies[1].centre, 1, 1, 1e-4 * size), {640, 640}, bodies, how);
                ++row.tried;
                bool good = tree.status == ChromeTreeStatus::ok && tree.passes() <= how.mostPictures;
                for (std::size_t n = 0; n < tree.nodes.size(); ++n) {
                    const ChromeNode& node = tree.nodes[n];
                    good = good && (node.parent == ChromeNode::none || node.parent < n) &&
                           static_cast<int>(node.level) <= how.depth &&
                           (node.look == ChromeLook::picture) == (node.size.x > 0) &&
                           std::isfinite(node.eye.x + node.eye.y + node.eye.z + node.pixels + node.stray);
                    if (node.look == ChromeLook::picture && eyes.size() < 8) eyes.push_back(node.eye);
                }
                if (!good) fail(row, "sizes " + std::to_string(size) + " and " + std::to_string(other));
            }
        }
    }
    row.worst = static_cast<double>(row.failures);
    return row;
}

}  // namespace

std::vector<Row> tryChrome(const Options& options) {
    SeededRandom random(options.seed, 83);
    std::vector<Row> rows;
    rows.push_back(sizes(options, random));
    options.tell(0.3);
    rows.push_back(parts(options, random));
    options.tell(0.6);
    rows.push_back(scales(options, random));
    options.tell(0.8);
    rows.push_back(meshes(options, random));
    options.tell(0.9);
    rows.push_back(bounces(options, random));
    options.tell(1);
    return rows;
}

}  // namespace app::stability
