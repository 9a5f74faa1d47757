#include "app/commands/ChromeShapes.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <stdexcept>

#include "app/commands/ChromeStage.h"
#include "app/frame/ChromeParts.h"
#include "app/mirrors/Lathe.h"
#include "app/mirrors/LitShapes.h"
#include "vehicles/import/LoadVehicle.h"
#include "vehicles/models/Fleet.h"

namespace app {

namespace {

/// (x^2 + y^2)^(e/2) + z^e = 1, stretched, with the surface's own normals: a ball for e = 2, a rounded
/// cylinder for more.
city::Mesh rounded(const glm::dvec3& radii, double e) {
    constexpr std::uint32_t rings = 160, sectors = 320;
    city::Mesh mesh;
    for (std::uint32_t j = 0; j <= rings; ++j)
        for (std::uint32_t i = 0; i <= sectors; ++i) {
            const double polar = 3.14159265358979 * j / rings;
            const double turn = 6.28318530717959 * (i % sectors) / sectors;
            const double sine = j == 0 || j == rings ? 0 : std::sin(polar), cosine = std::cos(polar);
            const glm::dvec3 d(sine * std::cos(turn), sine * std::sin(turn), cosine);
            const double q = std::pow(std::pow(sine, e) + std::pow(std::abs(cosine), e), 1 / e);
            const double out = std::pow(sine, e - 2), up = std::pow(std::abs(cosine), e - 2);
            city::Vertex v;
            v.position = glm::vec3(d / q * radii);
            v.normal = glm::vec3(glm::normalize(glm::dvec3(out, out, up) * d / radii));
            mesh.vertices.push_back(v);
        }
    for (std::uint32_t j = 0; j < rings; ++j)
        for (std::uint32_t i = 0; i < sectors; ++i) {
            const std::uint32_t a = j * (sectors + 1) + i, b = a + 1, c = a + sectors + 1, d = c + 1;
            mesh.indices.insert(mesh.indices.end(), {a, c, d, a, d, b});
        }
    return mesh;
}

city::Mesh turned(std::vector<glm::dvec2> profile) {
    Lathe lathe;
    lathe.profile = std::move(profile);
    lathe.steps = 16;
    lathe.slices = 320;
    return withoutLight(LatheSurface(lathe).mesh(glm::vec3(1), glm::vec3(1)));
}

/// What faces forwards in the front sixth of a car, between the road and the bonnet's edge.
city::Mesh frontOf(const vehicles::VehicleModel& car) {
    const city::Mesh& body = car.levels.front().body;
    float nose = -1e9f, tail = 1e9f;
    for (const city::Vertex& v : body.vertices)
        nose = std::max(nose, v.position.x), tail = std::min(tail, v.position.x);
    city::Mesh front;
    for (std::size_t k = 0; k + 2 < body.indices.size(); k += 3) {
        const city::Vertex* v[3];
        for (std::size_t i = 0; i < 3; ++i) v[i] = &body.vertices[body.indices[k + i]];
        const auto surface = static_cast<vehicles::Surface>(v[0]->material);
        if (surface != vehicles::Surface::paint && surface != vehicles::Surface::chrome) continue;
        const glm::vec3 across = glm::cross(v[1]->position - v[0]->position, v[2]->position - v[0]->position);
        const glm::vec3 middle = (v[0]->position + v[1]->position + v[2]->position) / 3.f;
        if (middle.x < nose - (nose - tail) / 6 || middle.z > 0.55f * car.height) continue;
        if (!(across.x > 0.5f * glm::length(across))) continue;
        for (const city::Vertex* each : v) {
            front.indices.push_back(static_cast<std::uint32_t>(front.vertices.size()));
            front.vertices.push_back(*each);
        }
    }
    return front;
}

ChromeShape shapeOf(std::string name, const city::Mesh& mesh, const glm::dvec3& from) {
    ChromeShape shape;
    shape.name = std::move(name);
    shape.reflector = reflection::makeReflector(mesh);
    shape.from = glm::normalize(from);
    glm::vec3 low(1e9f), high(-1e9f);
    for (const city::Vertex& v : mesh.vertices)
        low = glm::min(low, v.position), high = glm::max(high, v.position);
    shape.centre = 0.5 * glm::dvec3(low + high);
    shape.radius = 0.5 * glm::length(glm::dvec3(high - low));
    return shape;
}

}  // namespace

std::vector<ChromeShape> chromeShapes(const std::optional<std::filesystem::path>& car, double carLength) {
    std::vector<ChromeShape> shapes;
    shapes.push_back(shapeOf("ball", rounded(glm::dvec3(0.4), 2), {3, -2, 1}));
    shapes.push_back(shapeOf("ellipsoid", rounded({0.9, 0.3, 0.5}, 2), {3, -2, 1}));
    shapes.push_back(shapeOf("rounded cylinder", rounded({0.041, 0.041, 0.05}, 6), {3, -2, 1}));
    shapes.push_back(shapeOf("bowl's inside",
                             turned({{0.11, 0.07}, {0.1, 0.045}, {0.075, 0.021}, {0.04, 0.0075}, {0, 0.004}}),
                             {1, -2, 3}));
    const vehicles::VehicleModel model =
        car ? vehicles::loadVehicle(*car, static_cast<float>(carLength)) : vehicles::builtInFleet()[1];
    // The widest piece of chrome in front: a bumper, where it is one whole body.
    std::vector<city::Mesh> components = chromeComponents(model.levels.front().body);
    std::erase_if(components,
                  [](const city::Mesh& m) { return m.vertices.empty() || m.bounds().centre().x < 0; });
    const auto width = [](const city::Mesh& m) { return m.bounds().size().y; };
    const auto bumper =
        std::max_element(components.begin(), components.end(),
                         [&](const city::Mesh& a, const city::Mesh& b) { return width(a) < width(b); });
    if (bumper != components.end()) shapes.push_back(shapeOf(model.name + "'s bumper", *bumper, {4, -2, 1}));
    const city::Mesh front = frontOf(model);
    if (front.indices.empty())
        throw std::runtime_error(
            (car ? car->string() : model.name) +
            ": nothing of its front faces forwards; its nose must point along glTF's +z.");
    shapes.push_back(shapeOf(model.name + "'s front", front, {4, -2, 1}));
    return shapes;
}

std::vector<glm::dvec3> verticesAround(const ChromeShape& shape, std::size_t count,
                                       stability::SeededRandom& random) {
    std::vector<glm::dvec3> points;
    while (points.size() < count) {
        const glm::dvec3 d(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1));
        const double length = glm::length(d);
        if (length < 0.1 || length > 1) continue;
        points.push_back(shape.centre + shape.radius * random.magnitude(0.5, 6) / length * d);
    }
    return points;
}

}  // namespace app
