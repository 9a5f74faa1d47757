#include "app/frame/CloseImages.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>

#include "reflection/chrome/ReflectionSearch.h"

namespace app {

namespace {

constexpr std::size_t corners = 8, rays = 2, waysOfRay = 4, asked = corners + rays * waysOfRay;
static_assert(asked == searchesOfBox);

/// Of a place's distance: long enough to be told apart, short enough to be a derivative.
constexpr double shortWay = 0.02;

/// Chord between directions: their angle where that is small.
double apart(const glm::dvec3& a, const glm::dvec3& b) {
    return glm::length(glm::normalize(a) - glm::normalize(b));
}

}  // namespace

std::vector<CloseImage> closeImages(const reflection::ReflectorMap& map, double radius, const glm::dvec3& eye,
                                    std::span<const CloseBox> boxes) {
    std::vector<CloseImage> images(boxes.size());
    std::vector<glm::dvec3> places;
    places.reserve(asked * boxes.size());
    std::vector<double> away(boxes.size());
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        const CloseBox& b = boxes[i];
        if (b.box.empty()) {
            images[i].hidden = true;
            places.insert(places.end(), asked, glm::dvec3(0));
            continue;
        }
        const glm::dvec3 low(b.box.min), high(b.box.max);
        const auto inPart = [&](const glm::dvec3& p) { return glm::dvec3(b.partFromBox * glm::dvec4(p, 1)); };
        for (std::size_t c = 0; c < corners; ++c)
            places.push_back(inPart({(c & 1) != 0 ? high.x : low.x, (c & 2) != 0 ? high.y : low.y,
                                     (c & 4) != 0 ? high.z : low.z}));
        const glm::dvec3 part(glm::inverse(b.partFromBox)[3]);
        const glm::dvec3 nearest = glm::clamp(part, low, high), middle = 0.5 * (low + high);
        away[i] = glm::length(nearest - part);
        for (const glm::dvec3& from : {nearest, middle}) {
            const double way = shortWay * std::max(glm::length(from - part), radius);
            places.push_back(inPart(from));
            for (int axis = 0; axis < 3; ++axis) {
                glm::dvec3 to = from;
                to[axis] += from[axis] > middle[axis] ? -way : way;
                places.push_back(inPart(to));
            }
        }
    }
    std::vector<reflection::ReflectionPoint> points(places.size());
    reflection::SearchOptions options;
    options.thorough = false;
    reflection::findReflectionPoints(map, eye, places, points, options);
    const bool convex = map.bend() == reflection::Bend::convex;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        CloseImage& image = images[i];
        if (image.hidden) continue;
        const std::span<const reflection::ReflectionPoint> of(points.data() + i * asked, asked);
        const auto seen = [&](std::size_t k) {
            return reflection::virtualVertex(of[k], places[i * asked + k]) - eye;
        };
        const auto found = [&](std::size_t k) { return of[k].status == reflection::ReflectionStatus::found; };
        const double plane = std::max(glm::length(eye) - radius, 0.0) + std::max(away[i] - radius, 0.0);
        image.metresPerRadian = plane;
        image.angle = std::numeric_limits<double>::infinity();
        if (!convex) continue;
        image.hidden = std::ranges::all_of(of.first(corners), [](const reflection::ReflectionPoint& p) {
            return p.status == reflection::ReflectionStatus::hidden;
        });
        // In a box that holds the piece, or part of it, anything may be anywhere.
        if (image.hidden || away[i] <= radius) continue;
        double most = 0, across = 0;
        bool known = true;
        for (std::size_t r = 0; r < rays; ++r) {
            const std::size_t first = corners + r * waysOfRay;
            if (!found(first)) {
                known = known && r > 0;
                continue;
            }
            for (std::size_t k = 1; k < waysOfRay; ++k) {
                const double way = glm::length(places[i * asked + first + k] - places[i * asked + first]);
                if (found(first + k)) most = std::max(most, apart(seen(first), seen(first + k)) / way);
            }
        }
        if (known && most > 0) image.metresPerRadian = std::max(plane, 1 / most);
        for (std::size_t a = 0; a < corners; ++a)
            for (std::size_t b = a + 1; b < corners; ++b) across = std::max(across, apart(seen(a), seen(b)));
        image.angle = across;
    }
    return images;
}

}  // namespace app
