#include <algorithm>

#include "vehicles/models/Assemble.h"
#include "vehicles/models/Bodies.h"
#include "vehicles/models/Cage.h"
#include "vehicles/models/Outline.h"
#include "vehicles/models/Parts.h"
#include "vehicles/models/WheelArch.h"

namespace vehicles {
namespace {

constexpr float front = 2.95f, rear = -2.95f;  // axles

Cage cage() {
    Cage c;
    const auto ring = [&](float x, float bow, float width, float roof) {
        // From the front to the rear every ring is the same but for its place and its size; `bow` leans the
        // upper part back.
        c.stations.push_back({{x - bow * .16f, roof},
                              {x - bow * .20f, width * .80f, roof - .075f},
                              {x - bow * .10f, width * .965f, roof - .42f},
                              {x - bow * .02f, width, 2.05f},
                              {x, width, 1.10f},
                              {x, width * .995f, .48f},
                              {x - bow * .05f, width * .93f, .28f}});
    };
    ring(5.42f, 1, 1.14f, 2.98f);
    ring(5.25f, .6f, 1.25f, 3.06f);
    ring(4.70f, .2f, 1.275f, 3.09f);
    for (const float x : {3.0f, 1.0f, -1.0f, -3.0f, -5.3f}) ring(x, 0, 1.275f, 3.10f);
    ring(-6.08f, -.2f, 1.265f, 3.08f);
    ring(-6.24f, -.5f, 1.20f, 3.02f);
    c.frontX = {0, 5.50f, 5.63f, 5.67f, 5.67f, 5.60f};
    c.rearX = {0, -6.28f, -6.33f, -6.35f, -6.35f, -6.30f};
    const int last = static_cast<int>(c.stations.size()) - 1;
    c.creases = {
        {{0, 3, 0}, {last, 3, 0}, .6f},     {{0, 3, 5}, {last, 3, 5}, 3.0f},
        {{0, 0, 5}, {0, 3, 5}, 3.0f},       {{last, 0, 5}, {last, 3, 5}, 3.0f},
        {{last, 3, 0}, {last, 3, 5}, 1.0f}, {{last, 0, 0}, {last, 3, 0}, 1.0f},
        {{0, 0, 0}, {0, 3, 0}, .8f},
    };
    return c;
}

void drawLines(Shell& half) {
    half.assign(below(.36f), Surface::trim);
    // Skirt panels.
    for (const float x : {-5.0f, -1.6f, -.1f, 1.4f})
        addGap(half, inSideView(Outline({{x, .0f}, {x, 1.16f}, {x + 1.35f, 1.16f}, {x + 1.35f, .0f}}, .03f),
                                .9f, 0));
    addGap(half, inSideView(Outline({{-7.f, 2.72f}, {7.f, 2.72f}, {7.f, 4.f}, {-7.f, 4.f}}, 0), .9f, 0));
    // The band of windows: one dark strip, its panes divided by seals.
    addPanel(
        half,
        inSideView(Outline({{5.30f, 1.25f}, {5.20f, 2.66f}, {-6.02f, 2.66f}, {-6.02f, 1.30f}}, .08f), .9f, 1),
        Surface::trim);
    for (int i = 0; i < 7; ++i) {
        const float x = 4.05f - 1.44f * static_cast<float>(i);
        addGlass(half,
                 inSideView(Outline({{x, 1.30f}, {x, 2.60f}, {x - 1.38f, 2.60f}, {x - 1.38f, 1.30f}}, .05f),
                            .9f, 1),
                 .0f);
    }
    addGlass(
        half,
        inSideView(
            Outline({{5.20f, 1.20f}, {5.14f, 2.60f}, {4.11f, 2.60f}, {4.11f, 1.02f}, {4.6f, 1.02f}}, .08f),
            .9f, .8f),
        .02f);
    // Windscreen with the destination board over it.
    addPanel(half,
             roundTheFront(Outline({{{-.3f, 1.06f}, .05f},
                                    {{1.30f, 1.10f}, .10f},
                                    {{1.36f, 2.84f}, .12f},
                                    {{-.3f, 2.86f}, .05f}}),
                           5.62f),
             Surface::trim);
    addGlass(half,
             roundTheFront(Outline({{{-.3f, 1.10f}, .05f},
                                    {{1.27f, 1.14f}, .10f},
                                    {{1.33f, 2.50f}, .08f},
                                    {{-.3f, 2.52f}, .05f}}),
                           5.62f),
             .0f);
    addGlass(half,
             inFrontView(Outline({{-.3f, 2.56f}, {.90f, 2.56f}, {.86f, 2.80f}, {-.3f, 2.81f}}, .05f), 4.5f),
             .0f);
    // Front: lamps, lower grille, plate, bumper line.
    addPanel(half,
             roundTheFront(Outline({{.66f, .66f}, {1.25f, .68f}, {1.34f, .84f}, {.72f, .82f}}, .06f), 5.64f),
             Surface::headLamp, .015f);
    addPanel(half, inFrontView(Outline({{-.2f, .70f}, {.56f, .70f}, {.56f, .80f}, {-.2f, .80f}}, .03f), 5.0f),
             Surface::trim);
    addPanel(half, inFrontView(Outline({{-.2f, .47f}, {.26f, .47f}, {.26f, .58f}, {-.2f, .58f}}, .01f), 5.0f),
             Surface::rim, .006f);
    addGap(half, both(inFrontView(Outline({{-.2f, .90f}, {2.f, .90f}, {2.f, 1.4f}, {-.2f, 1.4f}}, 0), 5.0f),
                      below(1.f)));
    // Rear: window, engine lid with its louvres, lamps, plate.
    addGlass(half,
             inRearView(Outline({{-.3f, 1.75f}, {.98f, 1.75f}, {.95f, 2.60f}, {-.3f, 2.62f}}, .08f), -6.0f),
             .03f);
    addGap(half,
           inRearView(Outline({{-.2f, .62f}, {.86f, .62f}, {.86f, 1.58f}, {-.2f, 1.58f}}, .05f), -6.0f));
    for (const float z : {1.20f, 1.28f, 1.36f, 1.44f})
        addPanel(
            half,
            inRearView(Outline({{-.2f, z}, {.70f, z}, {.70f, z + .045f}, {-.2f, z + .045f}}, .01f), -6.0f),
            Surface::trim);
    addPanel(half,
             inRearView(Outline({{.94f, .70f}, {1.12f, .70f}, {1.12f, 1.40f}, {.94f, 1.40f}}, .04f), -6.0f),
             Surface::tailLamp, .01f);
    addPanel(half, inRearView(Outline({{-.2f, .80f}, {.26f, .80f}, {.26f, .91f}, {-.2f, .91f}}, .01f), -6.0f),
             Surface::rim, .01f);
}

/// Double doors on the right-hand side, where the kerb is.
void drawDoors(Shell& shell) {
    const auto onTheRight = [](Outline outline) -> Field {
        return [o = std::move(outline)](const glm::vec3& p, const glm::vec3&) {
            return std::max(o.distance({p.x, p.z}), p.y + .9f);
        };
    };
    for (const float x : {4.75f, .0f, -4.55f}) {
        const float half = x > 4 ? .52f : .62f;
        const Field frame = onTheRight(Outline({{x - half - .05f, .37f},
                                                {x + half + .05f, .37f},
                                                {x + half + .05f, 2.66f},
                                                {x - half - .05f, 2.66f}},
                                               .04f));
        shell.refine(frame, .06f);
        shell.assign(frame, Surface::trim);
        for (const float side : {-1.0f, 1.0f}) {
            const float a = x + side * .025f, b = x + side * half;
            const Field pane = onTheRight(Outline({{a, .46f}, {b, .46f}, {b, 2.58f}, {a, 2.58f}}, .05f));
            shell.refine(pane, .06f);
            shell.assign(pane, Surface::glass);
        }
    }
}

}  // namespace

VehicleModel bus() {
    Assembly plan{.name = "bus",
                  .length = 12.0f,
                  .width = 2.55f,
                  .height = 3.10f,
                  .track = 2.12f,
                  .wheel = {.radius = .48f, .width = .29f, .rimRadius = .30f, .spokes = 0},
                  .axles = {front, rear},
                  .triangles = 10000,
                  .tolerance = 0.0025f};
    Shell half = subdivide(
        cage(), {.rear = -6.35f, .front = 5.65f, .width = plan.width, .floor = .28f, .top = 3.02f}, 3);
    city::Mesh parts, single;
    drawLines(half);
    for (const float x : {front, rear})
        cutWheelArch(half, parts,
                     {.x = x, .z = plan.wheel.radius + .02f, .radius = .57f, .inner = .82f, .flare = 0});
    // Mirrors on arms before the front pillars, air conditioning on the roof.
    addBar(parts, {5.30f, 1.10f, 2.62f}, {5.72f, 1.36f, 2.55f}, .022f, 8, Surface::trim);
    addRounded(parts, {5.72f, 1.37f, 2.32f}, {.06f, .12f, .21f}, 4.0f, 14, Surface::trim);
    addRounded(single, {1.2f, 0, 3.02f}, {1.5f, .80f, .08f}, 7.0f, 24, Surface::paint);
    addRounded(single, {-3.9f, 0, 3.02f}, {1.1f, .72f, .08f}, 7.0f, 24, Surface::paint);
    return assemble(plan, std::move(half), parts, single, drawDoors);
}

}  // namespace vehicles
