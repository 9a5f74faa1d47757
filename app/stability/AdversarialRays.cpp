#include "app/stability/AdversarialRays.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

namespace app::stability {

namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

constexpr std::array<FieldKind, 14> kinds{{
    {"1 m cells", 24, 20, 1.0f, {0, 0}, Columns::town},
    {"1 m cells, borders off the origin", 17, 23, 1.0f, {-8.25, -11.7}, Columns::town},
    {"long streets of 1 m cells", 160, 140, 1.0f, {-20, 30}, Columns::town},
    {"0.05 m cells", 30, 26, 0.05f, {0.3, -0.7}, Columns::town},
    {"0.05 m cells 10^6 m from the origin", 30, 26, 0.05f, {1e6, -1e6}, Columns::town},
    {"2.7 m cells", 13, 12, 2.7f, {1234.567, 765.4}, Columns::town},
    {"100 m cells", 21, 19, 100.0f, {-1000, -900}, Columns::town},
    {"1 m cells 10^6 m from the origin", 24, 20, 1.0f, {1e6, -1e6}, Columns::town},
    {"steps of 1e-6 m", 24, 20, 1.0f, {0, 0}, Columns::fineSteps},
    {"steps of 1e-6 to 1e4 m", 24, 20, 1.0f, {-5, 7}, Columns::allSteps},
    {"no-data", 24, 20, 1.0f, {0, 0}, Columns::holes},
    {"endless columns", 24, 20, 1.0f, {0, 0}, Columns::endless},
    {"one height", 40, 3, 1.0f, {-1e5, 3e5}, Columns::flat},
    {"a single cell", 1, 1, 1.0f, {0, 0}, Columns::town},
}};

float townHeight(int i, int j, SeededRandom& random) {
    const bool block = i % 7 > 3 && j % 6 > 2;
    if (block) return 5.0f + static_cast<float>(((i / 7) * 5 + (j / 6) * 3) % 9);
    return static_cast<float>(random.below(3)) * 0.125f;
}

float heightOf(Columns columns, int i, int j, SeededRandom& random) {
    switch (columns) {
        case Columns::town:
            switch (random.below(60)) {
                case 0:
                    return infinity;
                case 1:
                    return -infinity;
                case 2:
                    return std::numeric_limits<float>::quiet_NaN();
                case 3:
                    return static_cast<float>(random.between(0, 12));
                case 4:
                    return -3;
                default:
                    return townHeight(i, j, random);
            }
        case Columns::solidTown:
            return random.oneIn(30) ? static_cast<float>(random.between(0, 12)) : townHeight(i, j, random);
        case Columns::fineSteps: {
            const float base = random.oneIn(3) ? 8.0f : 0.0f;
            if (random.oneIn(2)) return base + 1e-6f * static_cast<float>(random.below(5));
            return random.oneIn(2) ? std::nextafter(base, infinity) : base;
        }
        case Columns::allSteps:
            return (random.oneIn(4) ? -1.0f : 1.0f) * static_cast<float>(random.magnitude(1e-6, 1e4));
        case Columns::holes:
            if (random.below(5) < 2) return std::numeric_limits<float>::quiet_NaN();
            return random.oneIn(2) ? -infinity : townHeight(i, j, random);
        case Columns::endless:
            return random.oneIn(5) ? infinity : townHeight(i, j, random);
        case Columns::flat:
            return 3;
    }
    return 0;
}

/// What the families of rays draw from.
struct Draw {
    const city::Heightfield& field;
    SeededRandom& random;

    double extent(int axis) const {
        return (axis == 0 ? field.width() : field.height()) * static_cast<double>(field.cellSize());
    }
    float border(int axis) const {
        const int n = axis == 0 ? field.width() : field.height();
        return static_cast<float>(field.origin()[axis] +
                                  random.below(n + 1) * static_cast<double>(field.cellSize()));
    }
    /// Somewhere over or in the field: heights are spread as the columns', beside and just above them.
    glm::vec3 inside() const {
        return {static_cast<float>(field.origin().x + random.between(0, extent(0))),
                static_cast<float>(field.origin().y + random.between(0, extent(1))),
                random.oneIn(3) ? columnHeight() + static_cast<float>(random.magnitude(1e-6, 2))
                                : static_cast<float>(random.between(0.1, 14))};
    }
    float columnHeight() const {
        const float h = field.at(random.below(field.width()), random.below(field.height()));
        return std::isfinite(h) ? h : 1.5f;
    }
    glm::vec3 any() const {
        return {random.between(-1, 1), random.between(-1, 1), random.between(-1, 1) * random.unit()};
    }
    float either(float value) const { return random.oneIn(2) ? value : -value; }
    float nextTo(float value) const { return std::nextafter(value, either(infinity)); }
};

/// A point on a lattice of quarter cells, as near as floats come.
glm::vec3 latticePoint(const Draw& d) {
    const double quarter = 0.25 * static_cast<double>(d.field.cellSize());
    return {static_cast<float>(d.field.origin().x + d.random.below(4 * d.field.width() + 1) * quarter),
            static_cast<float>(d.field.origin().y + d.random.below(4 * d.field.height() + 1) * quarter),
            d.random.oneIn(2) ? d.columnHeight() : d.random.oneOf({0.5f, 1.5f, 5, 6, 7.25f})};
}

glm::vec3 rawDirection(RayFamily family, const glm::vec3& start, const Draw& d) {
    SeededRandom& random = d.random;
    glm::vec3 v = d.any();
    switch (family) {
        case RayFamily::alongEdges: {
            const int axis = random.below(2);
            v[axis] = random.oneOf({0.0f, -0.0f, 1e-30f, -1e-30f, 1e-45f});
            if (random.oneIn(2)) v.z = 0;
            break;
        }
        case RayFamily::throughCorners:
        case RayFamily::nearCorners:
            v.x = d.border(0) - start.x;
            v.y = d.border(1) - start.y;
            v.z = random.oneOf({0.0f, 0.5f, -0.5f, -0.125f, -2, 1}) * d.field.cellSize();
            if (family == RayFamily::nearCorners) v[random.below(2)] = d.nextTo(v[random.below(2)]);
            break;
        case RayFamily::grazingTops:
            v.z = random.oneOf({1e-7f, -1e-7f, 1e-9f, -1e-9f, 1e-12f, -1e-12f});
            break;
        case RayFamily::grazingWalls:
            v[random.below(2)] = random.oneOf({1e-7f, -1e-7f, 1e-9f, -1e-9f});
            if (random.oneIn(2)) v.z *= 1e-3f;
            break;
        case RayFamily::vertical:
            v = {random.oneOf({0, -0.0f, 1e-40f}), random.oneOf({0, -0.0f, -1e-40f}),
                 random.oneOf({1, -1, 1e-40f, -1e-40f})};
            break;
        case RayFamily::denormal:
            for (int c = 0; c < 3; ++c)
                if (random.oneIn(2)) v[c] *= random.oneOf({1e-38f, 1e-42f, 1e-45f});
            if (random.oneIn(3)) v *= 1e-44f;
            break;
        case RayFamily::zeroComponents:
            v[random.below(3)] = random.oneOf({0.0f, -0.0f});
            v[random.below(3)] = random.oneOf({0.0f, -0.0f});
            break;
        case RayFamily::onWalls:
            if (random.oneIn(2)) v = {d.either(1), random.oneOf({-1, 0, 1}), random.oneOf({-1, 0, 1, 0.25f})};
            break;
        case RayFamily::outside:
        case RayFamily::farAway: {
            const glm::vec3 target = random.oneIn(2) ? d.inside() : glm::vec3(d.border(0), d.border(1), 3);
            v = target - start;
            if (random.oneIn(8)) v = -v;
            break;
        }
        case RayFamily::onTops:
            v.z = random.oneOf({0, 0, -0.0f, -1e-6f, 1e-6f, -0.125f});
            break;
        case RayFamily::slowAndFast:
            v *= random.oneOf({1e-12f, 1e-20f, 1e-30f, 1e12f, 1e20f, 1e37f});
            break;
        case RayFamily::anywhere:
        case RayFamily::insideColumns:
        case RayFamily::count:
            break;
    }
    return v;
}

}  // namespace

std::span<const FieldKind> fieldKinds() {
    return kinds;
}

city::Heightfield makeField(const FieldKind& kind, SeededRandom& random) {
    city::Heightfield field(kind.width, kind.height, kind.cellSize, kind.origin);
    for (int j = 0; j < kind.height; ++j)
        for (int i = 0; i < kind.width; ++i) field.set(i, j, heightOf(kind.columns, i, j, random));
    return field;
}

std::string_view nameOf(RayFamily family) {
    constexpr std::array<std::string_view, static_cast<std::size_t>(RayFamily::count)> names{
        "anywhere",
        "along cell edges",
        "through cell corners",
        "a float beside corners",
        "grazing tops at 1e-7 rad and less",
        "grazing walls at 1e-7 rad and less",
        "vertical",
        "denormal components and starts",
        "zero components of both signs",
        "starting on walls",
        "starting inside columns",
        "starting outside the grid",
        "starting 1e4 to 1e37 m away",
        "in the plane of tops",
        "directions of 1e-30 to 1e37",
    };
    return names[static_cast<std::size_t>(family)];
}

glm::vec3 startOf(RayFamily family, const city::Heightfield& field, SeededRandom& random) {
    const Draw d{field, random};
    glm::vec3 start = d.inside();
    const auto toBorder = [&](int axis) { start[axis] = d.border(axis); };
    switch (family) {
        case RayFamily::alongEdges:
            toBorder(random.below(2));
            if (random.oneIn(3)) toBorder(random.below(2));
            break;
        case RayFamily::throughCorners:
        case RayFamily::nearCorners:
            start = latticePoint(d);
            break;
        case RayFamily::grazingTops:
            start.z = random.oneIn(2) ? d.columnHeight() : d.nextTo(d.columnHeight());
            break;
        case RayFamily::grazingWalls: {
            const int axis = random.below(2);
            start[axis] = random.oneIn(2) ? d.border(axis) : d.nextTo(d.border(axis));
            break;
        }
        case RayFamily::vertical:
            if (random.oneIn(2)) toBorder(0);
            if (random.oneIn(2)) toBorder(1);
            break;
        case RayFamily::denormal:
            if (random.oneIn(2)) start[random.below(3)] = random.oneOf({1e-45f, -1e-45f, 1e-39f, 0});
            break;
        case RayFamily::onWalls:
            toBorder(0);
            if (random.oneIn(2)) toBorder(1);
            if (random.oneIn(2)) start.z = d.columnHeight();
            break;
        case RayFamily::insideColumns:
            start.z = d.columnHeight() - static_cast<float>(random.magnitude(1e-6, 1e4));
            break;
        case RayFamily::outside:
            start.x += static_cast<float>(random.between(-3, 3) * d.extent(0));
            start.y += static_cast<float>(random.between(-3, 3) * d.extent(1));
            if (random.oneIn(4)) start.z = static_cast<float>(random.between(-5, 40));
            break;
        case RayFamily::farAway:
            start -= random.oneOf({1e4f, 1e6f, 1e9f, 1e20f, 1e37f}) * d.any();
            break;
        case RayFamily::onTops:
            start.z = d.columnHeight();
            break;
        case RayFamily::anywhere:
        case RayFamily::zeroComponents:
        case RayFamily::slowAndFast:
        case RayFamily::count:
            break;
    }
    return start;
}

glm::vec3 directionOf(RayFamily family, const city::Heightfield& field, const glm::vec3& start,
                      SeededRandom& random) {
    glm::vec3 v = rawDirection(family, start, {field, random});
    for (int c = 0; c < 3; ++c)
        if (!std::isfinite(v[c])) v[c] = 1;
    if (v == glm::vec3(0)) v[random.below(3)] = random.oneOf({1e-45f, -1, 1});
    return v;
}

std::string described(const city::Ray& ray, std::string_view field, std::uint64_t seed) {
    std::array<char, 320> text{};
    std::snprintf(text.data(), text.size(), "%.*s, seed %llu, origin (%a, %a, %a) direction (%a, %a, %a)",
                  static_cast<int>(field.size()), field.data(), static_cast<unsigned long long>(seed),
                  static_cast<double>(ray.origin.x), static_cast<double>(ray.origin.y),
                  static_cast<double>(ray.origin.z), static_cast<double>(ray.direction.x),
                  static_cast<double>(ray.direction.y), static_cast<double>(ray.direction.z));
    return text.data();
}

}  // namespace app::stability
