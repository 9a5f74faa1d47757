#include <cmath>

#include "vehicles/models/Assemble.h"
#include "vehicles/models/Bodies.h"
#include "vehicles/models/Cage.h"
#include "vehicles/models/Outline.h"
#include "vehicles/models/Parts.h"

namespace vehicles {
namespace {

constexpr float halfLength = 7.35f;

/// A car for both directions: the front and the rear are the same.
Cage cage() {
    Cage c;
    const auto ring = [&](float x, float bow, float width, float roof) {
        const float lean = x > 0 ? bow : -bow;
        c.stations.push_back({{x - lean * .55f, roof},
                              {x - lean * .60f, width * .80f, roof - .10f},
                              {x - lean * .40f, width * .95f, roof - .46f},
                              {x - lean * .12f, width, 1.95f},
                              {x, width, 1.00f},
                              {x, width * .99f, .46f},
                              {x - lean * .15f, width * .93f, .18f}});
    };
    ring(6.88f, 1, .95f, 3.16f);
    ring(6.55f, .75f, 1.12f, 3.26f);
    ring(5.80f, .30f, 1.19f, 3.32f);
    for (const float x : {4.4f, 1.5f, -1.5f, -4.4f}) ring(x, 0, 1.20f, 3.34f);
    ring(-5.80f, .30f, 1.19f, 3.32f);
    ring(-6.55f, .75f, 1.12f, 3.26f);
    ring(-6.88f, 1, .95f, 3.16f);
    c.frontX = {0, 6.75f, 7.15f, 7.35f, 7.33f, 7.15f};
    for (int l = 1; l <= Cage::levels; ++l) c.rearX[l] = -c.frontX[l];
    const int last = static_cast<int>(c.stations.size()) - 1;
    c.creases = {{{0, 3, 0}, {last, 3, 0}, .6f},
                 {{0, 3, 5}, {last, 3, 5}, 3.0f},
                 {{0, 0, 5}, {0, 3, 5}, 3.0f},
                 {{last, 0, 5}, {last, 3, 5}, 3.0f}};
    return c;
}

/// The same on the left and the right, at the front and at the rear.
Field atBothEnds(const Field& field) {
    return [field](const glm::vec3& p, const glm::vec3& n) {
        return field({std::abs(p.x), p.y, p.z}, {p.x < 0 ? -n.x : n.x, n.y, n.z});
    };
}

void drawLines(Shell& half) {
    half.assign(below(.30f), Surface::trim);
    addGap(half, inSideView(Outline({{-9.f, .0f}, {9.f, .0f}, {9.f, .62f}, {-9.f, .62f}}, 0), .8f, 0));
    for (const float x : {4.4f, -1.0f}) {
        addGap(half,
               inSideView(Outline({{x, .0f}, {x, .62f}, {x - 3.4f, .62f}, {x - 3.4f, .0f}}, .0f), .9f, 0));
    }
    addPanel(
        half,
        inSideView(Outline({{6.0f, 1.15f}, {5.75f, 2.72f}, {-5.75f, 2.72f}, {-6.0f, 1.15f}}, .10f), .8f, .9f),
        Surface::trim);
    // Doors at both ends of the saloon, windows between them.
    for (const float x : {4.55f, -4.55f, 1.25f, -1.25f}) {
        addPanel(
            half,
            inSideView(
                Outline({{x - .68f, .40f}, {x + .68f, .40f}, {x + .68f, 2.72f}, {x - .68f, 2.72f}}, .04f),
                .8f, .3f),
            Surface::trim);
        for (const float side : {-1.0f, 1.0f}) {
            const float a = x + side * .025f, b = x + side * .63f;
            addGlass(half,
                     inSideView(Outline({{a, .62f}, {b, .62f}, {b, 2.62f}, {a, 2.62f}}, .06f), .8f, .3f), 0);
        }
    }
    const auto window = [&](float a, float b) {
        addGlass(half, inSideView(Outline({{a, 1.20f}, {b, 1.20f}, {b, 2.64f}, {a, 2.64f}}, .06f), .8f, .9f),
                 0);
    };
    window(-.52f, .52f);
    for (const float side : {-1.0f, 1.0f}) {
        window(side * 1.98f, side * 2.86f);
        window(side * 2.92f, side * 3.82f);
        window(side * 5.28f, side * 5.70f);
    }
    addPanel(half,
             atBothEnds(roundTheFront(Outline({{{-.3f, 1.18f}, .05f},
                                               {{1.36f, 1.22f}, .12f},
                                               {{1.86f, 2.80f}, .16f},
                                               {{-.3f, 3.02f}, .05f}}),
                                      7.25f)),
             Surface::trim);
    addGlass(half,
             atBothEnds(roundTheFront(Outline({{{-.3f, 1.22f}, .05f},
                                               {{1.32f, 1.26f}, .12f},
                                               {{1.76f, 2.58f}, .12f},
                                               {{-.3f, 2.62f}, .05f}}),
                                      7.25f)),
             0);
    addGlass(half,
             atBothEnds(inFrontView(
                 Outline({{-.3f, 2.68f}, {.70f, 2.68f}, {.60f, 2.90f}, {-.3f, 2.92f}}, .04f), 5.f)),
             0);
    addPanel(half,
             atBothEnds(roundTheFront(
                 Outline({{.62f, .82f}, {.98f, .84f}, {1.06f, .96f}, {.62f, .94f}}, .05f), 7.25f)),
             Surface::headLamp, .015f);
    addPanel(half,
             atBothEnds(roundTheFront(
                 Outline({{1.00f, .70f}, {1.16f, .71f}, {1.20f, .79f}, {1.00f, .78f}}, .03f), 7.25f)),
             Surface::tailLamp, .01f);
    addPanel(
        half,
        atBothEnds(inFrontView(Outline({{-.2f, .36f}, {.70f, .38f}, {.70f, .56f}, {-.2f, .56f}}, .05f), 6.f)),
        Surface::trim);
    addGap(half, atBothEnds(
                     both(inFrontView(Outline({{-.2f, .66f}, {3.f, .66f}, {3.f, 3.f}, {-.2f, 3.f}}, 0), 6.4f),
                          below(.8f))));
}

void addPantograph(city::Mesh& mesh) {
    const float foot = 3.40f, knee = 3.72f, head = 4.15f;
    for (const float y : {-.45f, .45f}) {
        addBar(mesh, {.55f, y, foot}, {-.55f, y * .5f, knee}, .028f, 8, Surface::trim);
        addBar(mesh, {-.55f, y * .5f, knee}, {.35f, y * .6f, head}, .022f, 8, Surface::trim);
        addBar(mesh, {.65f, y, foot - .12f}, {.55f, y, foot}, .03f, 8, Surface::trim);
    }
    addBar(mesh, {-.55f, -.3f, knee}, {-.55f, .3f, knee}, .022f, 8, Surface::trim);
    for (const float x : {.20f, .50f})
        addBar(mesh, {x, -.75f, head + .02f}, {x, .75f, head + .02f}, .025f, 8, Surface::chrome);
    addBar(mesh, {.20f, -.4f, head}, {.50f, -.4f, head}, .02f, 8, Surface::trim);
    addBar(mesh, {.20f, .4f, head}, {.50f, .4f, head}, .02f, 8, Surface::trim);
}

}  // namespace

VehicleModel tram() {
    Assembly plan{.name = "tram",
                  .length = 2 * halfLength,
                  .width = 2.40f,
                  .height = 3.40f,
                  .track = 1.435f + .06f,
                  .wheel = {.radius = .30f, .width = .12f, .rimRadius = .26f, .spokes = 0, .tyre = false},
                  .axles = {4.6f, 2.8f, -2.8f, -4.6f},
                  .triangles = 10000,
                  .tolerance = 0.0025f,
                  .noneSteer = true};
    Shell half = subdivide(
        cage(), {.rear = -halfLength, .front = halfLength, .width = plan.width, .floor = .16f, .top = 3.28f},
        3);
    city::Mesh parts, single;
    drawLines(half);
    addRounded(single, {3.6f, 0, 3.26f}, {1.5f, .78f, .14f}, 6.0f, 24, Surface::paint);
    addRounded(single, {-3.6f, 0, 3.26f}, {1.5f, .78f, .14f}, 6.0f, 24, Surface::paint);
    addBox(single, {-.8f, -.55f, 3.2f}, {.8f, .55f, 3.30f}, Surface::trim);
    addPantograph(single);
    return assemble(plan, std::move(half), parts, single);
}

}  // namespace vehicles
